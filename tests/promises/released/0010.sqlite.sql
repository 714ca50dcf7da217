BEGIN TRANSACTION;
CREATE TABLE about (
	id VARCHAR NOT NULL, owner BIGINT DEFAULT '0' NOT NULL, 
	PRIMARY KEY (id)
);
INSERT INTO "about" VALUES('1ed898d73c295103',1);
CREATE TABLE alembic_version (
	version_num VARCHAR(32) NOT NULL, 
	CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num)
);
INSERT INTO "alembic_version" VALUES('0010');
CREATE TABLE artifacts (
	run_id VARCHAR NOT NULL, 
	name VARCHAR NOT NULL, 
	file VARCHAR NOT NULL, 
	size BIGINT NOT NULL, 
	sha256 VARCHAR NOT NULL, 
	written_at DATETIME NOT NULL, 
	PRIMARY KEY (run_id, name), 
	FOREIGN KEY(run_id) REFERENCES runs (id) ON DELETE CASCADE, 
	UNIQUE (file)
);
INSERT INTO "artifacts" VALUES('0pmz0000a0001','q-table.npz','1a26554ec9ea5fc942b7682b31ea659b',1024,'785b0751fc2c53dc14a4ce3d800e69ef9ce1009eb327ccf458afe09c242c26c9','2026-11-25 21:32:38.353098');
CREATE TABLE evaluations (
	run_id VARCHAR NOT NULL, 
	step BIGINT NOT NULL, 
	distance_m DOUBLE, 
	epsilon DOUBLE, 
	PRIMARY KEY (run_id, step), 
	FOREIGN KEY(run_id) REFERENCES runs (id) ON DELETE CASCADE
);
INSERT INTO "evaluations" VALUES('0pmz0000a0001',50,0.125,1.0);
INSERT INTO "evaluations" VALUES('0pmz0000a0001',100,-0.25,0.9);
CREATE TABLE idempotency_keys (
	"key" VARCHAR NOT NULL, 
	digest VARCHAR NOT NULL, 
	run_id VARCHAR NOT NULL, 
	created_at DATETIME NOT NULL, 
	PRIMARY KEY ("key")
);
CREATE TABLE lessons (
	id VARCHAR NOT NULL, 
	title VARCHAR NOT NULL, 
	document JSON NOT NULL, 
	created_at DATETIME NOT NULL, 
	PRIMARY KEY (id)
);
CREATE TABLE participants (
	room VARCHAR NOT NULL, 
	seed BIGINT NOT NULL, 
	name VARCHAR NOT NULL, 
	key_sha256 VARCHAR NOT NULL, 
	is_name_hidden BOOLEAN NOT NULL, 
	is_approved BOOLEAN NOT NULL, 
	joined_at DATETIME NOT NULL, 
	left_at DATETIME, 
	PRIMARY KEY (room, seed), 
	FOREIGN KEY(room) REFERENCES rooms (code) ON DELETE CASCADE, 
	UNIQUE (key_sha256)
);
CREATE TABLE predictions (
	room VARCHAR NOT NULL, 
	seed BIGINT NOT NULL, 
	card BIGINT NOT NULL, 
	value JSON NOT NULL, 
	made_at DATETIME NOT NULL, 
	PRIMARY KEY (room, seed, card), 
	FOREIGN KEY(room) REFERENCES rooms (code) ON DELETE CASCADE
);
CREATE TABLE robots (
	id VARCHAR NOT NULL, 
	name VARCHAR NOT NULL, 
	hidden BIGINT DEFAULT '0' NOT NULL, 
	gait JSON, 
	guesses JSON NOT NULL, 
	repairs JSON NOT NULL, 
	choices JSON, 
	file VARCHAR, 
	created_at DATETIME NOT NULL, 
	PRIMARY KEY (id)
);
CREATE TABLE room_runs (
	run_id VARCHAR NOT NULL, 
	room VARCHAR NOT NULL, 
	seed BIGINT NOT NULL, 
	card BIGINT NOT NULL, 
	given JSON NOT NULL, 
	is_main BOOLEAN NOT NULL, 
	is_shown BOOLEAN NOT NULL, 
	created_at DATETIME NOT NULL, answer JSON, 
	PRIMARY KEY (run_id), 
	FOREIGN KEY(room) REFERENCES rooms (code) ON DELETE CASCADE
);
CREATE TABLE rooms (
	code VARCHAR NOT NULL, 
	lesson_id VARCHAR, 
	lesson JSON NOT NULL, 
	card BIGINT NOT NULL, 
	revealed JSON NOT NULL, 
	is_frozen BOOLEAN NOT NULL, 
	needs_approval BOOLEAN NOT NULL, 
	spotlight VARCHAR, 
	created_at DATETIME NOT NULL, 
	ended_at DATETIME, 
	PRIMARY KEY (code)
);
CREATE TABLE runs (
	id VARCHAR NOT NULL, 
	kind VARCHAR NOT NULL, 
	name VARCHAR NOT NULL, 
	state VARCHAR NOT NULL, 
	config JSON NOT NULL, 
	lane_training_ids JSON NOT NULL, 
	waiting_for JSON NOT NULL, 
	continued_from VARCHAR, 
	done BIGINT NOT NULL, 
	total BIGINT NOT NULL, 
	eta_s DOUBLE, 
	changes JSON NOT NULL, 
	greedy_distance_m DOUBLE, 
	result JSON, 
	error VARCHAR, 
	created_at DATETIME NOT NULL, 
	started_at DATETIME, 
	ended_at DATETIME, workers BIGINT, tags VARCHAR DEFAULT '' NOT NULL, notes VARCHAR DEFAULT '' NOT NULL, distance_m DOUBLE, is_imported BOOLEAN DEFAULT 0 NOT NULL, 
	PRIMARY KEY (id)
);
INSERT INTO "runs" VALUES('0pmz0000a0001','training','Grüße, ''quoted'' \ and so on','finished','{"gait": {"right_leg": 1, "left_leg": 4, "pairs": [[1, 4], [2, 6], [3, 5]]}, "robot": {"preset": "slippery", "legs": [{"azimuth_deg": 0.0, "radius_m": 0.12}, {"azimuth_deg": 60.0, "radius_m": 0.12}, {"azimuth_deg": 120.0, "radius_m": 0.12}, {"azimuth_deg": 180.0, "radius_m": 0.12}, {"azimuth_deg": 240.0, "radius_m": 0.12}, {"azimuth_deg": 300.0, "radius_m": 0.12}], "femur_m": 0.09}, "simulator": "kinematic", "divisions": 2, "grid_side_m": 0.04, "disturbances": [], "tolerance": 0.0, "steps": 500, "seed": 1208925819614629174706176, "observation": "measured", "settings": {"alpha": 0.3, "gamma": 0.9, "epsilon_start": 1.0, "epsilon_end": 0.0}, "steps_per_episode": 50, "evaluate_every": 50, "pace": 2.5, "agent": "my.module:Agent"}','[]','[]',NULL,500,500,NULL,'[{"step": 20, "settings": {"alpha": 0.1}}, {"step": 30, "pace": "max"}]',0.4321,'{"distance_m": null, "greedy_distance_m": null, "best_known_m": null, "q_table_sha256": "abababababababababababababababababababababababababababababababab", "fell_at_step": null}',NULL,'2026-02-28 23:59:59.123456','2026-03-01 00:00:00.123456','2026-03-01 00:59:59.123456',NULL,'
Übung 1

kept
','Slips.
	Next: µ = 0.4',NULL,0);
INSERT INTO "runs" VALUES('0pmz0000a0002','training','training 0pmz0000a0002','failed','{"gait": "left-right-origin", "robot": {"preset": "stiff"}, "simulator": "mujoco", "divisions": 2, "grid_side_m": 0.04, "disturbances": [], "tolerance": 0.0, "steps": 500, "seed": 0, "observation": "measured", "settings": {"alpha": 0.3, "gamma": 0.9, "epsilon_start": 1.0, "epsilon_end": 0.0}, "steps_per_episode": 50, "evaluate_every": 50, "pace": "max", "agent": "q-learning"}','[]','[]','0pmz0000a0001',0,500,NULL,'[]',NULL,NULL,'The physics diverged.','2026-02-28 23:59:59.123456',NULL,NULL,NULL,'','',NULL,0);
INSERT INTO "runs" VALUES('0pmz0000a0003','race','race 0pmz0000a0003','stopped','{"gait": "front-back-vertical", "robot": {"preset": "stiff"}, "simulator": "mujoco", "divisions": 2, "grid_side_m": 0.04, "disturbances": [], "tolerance": 0.0, "lanes": [{"agent": "q-learning", "observation": "commanded", "keep_learning": false, "plans_with": null, "settings": {}}, {"agent": "greedy", "observation": "measured", "keep_learning": false, "plans_with": null, "settings": {}}], "steps": 50, "seed": 0, "branch_from": null}','["abc", null]','[]',NULL,0,100,NULL,'[]',NULL,'{"lanes": [], "recording_sha256": null, "shared_machine": false}',NULL,'2026-02-28 23:59:59.123456',NULL,'2026-02-28 23:59:59.123456',NULL,'','',NULL,0);
INSERT INTO "runs" VALUES('0pmz0000a0004','experiment','experiment 0pmz0000a0004','interrupted','{"experiment": "sweep", "seeds": 3, "seed": 1208925819614629174706176, "agents": ["q-learning", "my.module:Agent"], "gaits": ["left-right-origin", {"right_leg": 1, "left_leg": 4, "pairs": [[1, 4], [2, 6], [3, 5]]}], "observations": ["commanded"], "robots": [{"preset": "stiff"}, {"preset": "slippery", "legs": [{"azimuth_deg": 0.0, "radius_m": 0.12}, {"azimuth_deg": 60.0, "radius_m": 0.12}, {"azimuth_deg": 120.0, "radius_m": 0.12}, {"azimuth_deg": 180.0, "radius_m": 0.12}, {"azimuth_deg": 240.0, "radius_m": 0.12}, {"azimuth_deg": 300.0, "radius_m": 0.12}], "femur_m": 0.09}], "simulator": "kinematic", "steps": [500], "settings": {"alpha": [0.1, 0.3], "gamma": [0.9], "epsilon_start": [1.0], "epsilon_end": [0.0]}, "steps_per_episode": [50], "divisions": [2, 3], "grid_side_m": [0.04], "blocks": 1, "worlds": ["flat"], "tolerance": 0.0}','[]','[]',NULL,2,100,NULL,'[]',NULL,NULL,NULL,'2026-02-28 23:59:59.123456',NULL,'2026-02-28 23:59:59.123456',2,'','',NULL,0);
CREATE TABLE sessions (
	id_sha256 VARCHAR NOT NULL, 
	token_sha256 VARCHAR NOT NULL, 
	created_at DATETIME NOT NULL, 
	expires_at DATETIME NOT NULL, 
	PRIMARY KEY (id_sha256)
);
CREATE TABLE tournament_entries (
	tournament VARCHAR NOT NULL, 
	number BIGINT NOT NULL, 
	seed BIGINT, 
	name VARCHAR NOT NULL, 
	is_reference BOOLEAN NOT NULL, 
	entry JSON NOT NULL, 
	training_id VARCHAR, 
	is_withdrawn BOOLEAN NOT NULL, 
	entered_at DATETIME NOT NULL, 
	PRIMARY KEY (tournament, number), 
	FOREIGN KEY(tournament) REFERENCES tournaments (id) ON DELETE CASCADE
);
CREATE TABLE tournament_judgements (
	tournament VARCHAR NOT NULL, 
	number BIGINT NOT NULL, 
	draw BIGINT NOT NULL, 
	distance_m DOUBLE NOT NULL, 
	failure VARCHAR, 
	PRIMARY KEY (tournament, number, draw), 
	FOREIGN KEY(tournament) REFERENCES tournaments (id) ON DELETE CASCADE
);
CREATE TABLE tournament_tables (
	tournament VARCHAR NOT NULL, 
	sha256 VARCHAR NOT NULL, 
	data VARCHAR NOT NULL, 
	PRIMARY KEY (tournament, sha256), 
	FOREIGN KEY(tournament) REFERENCES tournaments (id) ON DELETE CASCADE
);
CREATE TABLE tournaments (
	id VARCHAR NOT NULL, 
	title VARCHAR NOT NULL, 
	room VARCHAR, 
	rules JSON NOT NULL, 
	secret VARCHAR NOT NULL, 
	entries_per_hour BIGINT NOT NULL, 
	state VARCHAR NOT NULL, 
	outcome JSON, 
	created_at DATETIME NOT NULL, 
	ended_at DATETIME, 
	PRIMARY KEY (id)
);
CREATE TABLE trials (
	run_id VARCHAR NOT NULL, 
	"key" VARCHAR NOT NULL, 
	result JSON, 
	set_aside VARCHAR, 
	compute_s DOUBLE NOT NULL, 
	PRIMARY KEY (run_id, "key"), 
	FOREIGN KEY(run_id) REFERENCES runs (id) ON DELETE CASCADE
);
INSERT INTO "trials" VALUES('0pmz0000a0004','left-right-origin/commanded/stiff/greedy#0','{"distances_m": [0.49666, -0.25], "finished_distance_m": null, "elapsed_s": 1.5, "transitions": 600, "wall": [{"agent": "greedy", "rank": 1}], "failure": null}',NULL,0.0125);
INSERT INTO "trials" VALUES('0pmz0000a0004','left-right-origin/commanded/stiff/q-learning/500/α=0.1#12',NULL,'it ended its worker''s process 3 times',0.0);
CREATE TABLE visitor_runs (
	run_id VARCHAR NOT NULL, 
	visitor VARCHAR NOT NULL, 
	steps BIGINT NOT NULL, 
	is_main BOOLEAN NOT NULL, 
	created_at DATETIME NOT NULL, 
	PRIMARY KEY (run_id)
);
CREATE INDEX ix_runs_kind_id ON runs (kind, id);
CREATE INDEX ix_runs_kind_state_id ON runs (kind, state, id);
CREATE INDEX ix_runs_state_id ON runs (state, id);
CREATE INDEX ix_idempotency_keys_created_at ON idempotency_keys (created_at);
CREATE INDEX ix_sessions_expires_at ON sessions (expires_at);
CREATE INDEX ix_room_runs_room_card_seed ON room_runs (room, card, seed);
COMMIT;
