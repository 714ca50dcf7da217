CREATE TABLE public.about (
    id character varying NOT NULL COLLATE pg_catalog."C",
    owner bigint DEFAULT '0'::bigint NOT NULL
);
CREATE TABLE public.alembic_version (
    version_num character varying(32) NOT NULL
);
CREATE TABLE public.artifacts (
    run_id character varying NOT NULL COLLATE pg_catalog."C",
    name character varying NOT NULL COLLATE pg_catalog."C",
    file character varying NOT NULL COLLATE pg_catalog."C",
    size bigint NOT NULL,
    sha256 character varying NOT NULL COLLATE pg_catalog."C",
    written_at timestamp with time zone NOT NULL
);
CREATE TABLE public.evaluations (
    run_id character varying NOT NULL COLLATE pg_catalog."C",
    step bigint NOT NULL,
    distance_m double precision,
    epsilon double precision
);
CREATE TABLE public.idempotency_keys (
    key character varying NOT NULL COLLATE pg_catalog."C",
    digest character varying NOT NULL COLLATE pg_catalog."C",
    run_id character varying NOT NULL COLLATE pg_catalog."C",
    created_at timestamp with time zone NOT NULL
);
CREATE TABLE public.lessons (
    id character varying NOT NULL COLLATE pg_catalog."C",
    title character varying NOT NULL COLLATE pg_catalog."C",
    document json NOT NULL,
    created_at timestamp with time zone NOT NULL
);
CREATE TABLE public.participants (
    room character varying NOT NULL COLLATE pg_catalog."C",
    seed bigint NOT NULL,
    name character varying NOT NULL COLLATE pg_catalog."C",
    key_sha256 character varying NOT NULL COLLATE pg_catalog."C",
    is_name_hidden boolean NOT NULL,
    is_approved boolean NOT NULL,
    joined_at timestamp with time zone NOT NULL,
    left_at timestamp with time zone
);
CREATE TABLE public.predictions (
    room character varying NOT NULL COLLATE pg_catalog."C",
    seed bigint NOT NULL,
    card bigint NOT NULL,
    value json NOT NULL,
    made_at timestamp with time zone NOT NULL
);
CREATE TABLE public.robots (
    id character varying NOT NULL COLLATE pg_catalog."C",
    name character varying NOT NULL COLLATE pg_catalog."C",
    hidden bigint DEFAULT '0'::bigint NOT NULL,
    gait json,
    guesses json NOT NULL,
    repairs json NOT NULL,
    choices json,
    file character varying COLLATE pg_catalog."C",
    created_at timestamp with time zone NOT NULL
);
CREATE TABLE public.room_runs (
    run_id character varying NOT NULL COLLATE pg_catalog."C",
    room character varying NOT NULL COLLATE pg_catalog."C",
    seed bigint NOT NULL,
    card bigint NOT NULL,
    given json NOT NULL,
    is_main boolean NOT NULL,
    is_shown boolean NOT NULL,
    created_at timestamp with time zone NOT NULL,
    answer json
);
CREATE TABLE public.rooms (
    code character varying NOT NULL COLLATE pg_catalog."C",
    lesson_id character varying COLLATE pg_catalog."C",
    lesson json NOT NULL,
    card bigint NOT NULL,
    revealed json NOT NULL,
    is_frozen boolean NOT NULL,
    needs_approval boolean NOT NULL,
    spotlight character varying COLLATE pg_catalog."C",
    created_at timestamp with time zone NOT NULL,
    ended_at timestamp with time zone
);
CREATE TABLE public.runs (
    id character varying NOT NULL COLLATE pg_catalog."C",
    kind character varying NOT NULL COLLATE pg_catalog."C",
    name character varying NOT NULL COLLATE pg_catalog."C",
    state character varying NOT NULL COLLATE pg_catalog."C",
    config json NOT NULL,
    lane_training_ids json NOT NULL,
    waiting_for json NOT NULL,
    continued_from character varying COLLATE pg_catalog."C",
    done bigint NOT NULL,
    total bigint NOT NULL,
    eta_s double precision,
    changes json NOT NULL,
    greedy_distance_m double precision,
    result json,
    error character varying COLLATE pg_catalog."C",
    created_at timestamp with time zone NOT NULL,
    started_at timestamp with time zone,
    ended_at timestamp with time zone,
    workers bigint,
    tags character varying DEFAULT ''::character varying NOT NULL COLLATE pg_catalog."C",
    notes character varying DEFAULT ''::character varying NOT NULL COLLATE pg_catalog."C",
    distance_m double precision,
    is_imported boolean DEFAULT false NOT NULL
);
CREATE TABLE public.sessions (
    id_sha256 character varying NOT NULL COLLATE pg_catalog."C",
    token_sha256 character varying NOT NULL COLLATE pg_catalog."C",
    created_at timestamp with time zone NOT NULL,
    expires_at timestamp with time zone NOT NULL
);
CREATE TABLE public.tournament_entries (
    tournament character varying NOT NULL COLLATE pg_catalog."C",
    number bigint NOT NULL,
    seed bigint,
    name character varying NOT NULL COLLATE pg_catalog."C",
    is_reference boolean NOT NULL,
    entry json NOT NULL,
    training_id character varying COLLATE pg_catalog."C",
    is_withdrawn boolean NOT NULL,
    entered_at timestamp with time zone NOT NULL
);
CREATE TABLE public.tournament_judgements (
    tournament character varying NOT NULL COLLATE pg_catalog."C",
    number bigint NOT NULL,
    draw bigint NOT NULL,
    distance_m double precision NOT NULL,
    failure character varying COLLATE pg_catalog."C"
);
CREATE TABLE public.tournament_tables (
    tournament character varying NOT NULL COLLATE pg_catalog."C",
    sha256 character varying NOT NULL COLLATE pg_catalog."C",
    data character varying NOT NULL COLLATE pg_catalog."C"
);
CREATE TABLE public.tournaments (
    id character varying NOT NULL COLLATE pg_catalog."C",
    title character varying NOT NULL COLLATE pg_catalog."C",
    room character varying COLLATE pg_catalog."C",
    rules json NOT NULL,
    secret character varying NOT NULL COLLATE pg_catalog."C",
    entries_per_hour bigint NOT NULL,
    state character varying NOT NULL COLLATE pg_catalog."C",
    outcome json,
    created_at timestamp with time zone NOT NULL,
    ended_at timestamp with time zone
);
CREATE TABLE public.trials (
    run_id character varying NOT NULL COLLATE pg_catalog."C",
    key character varying NOT NULL COLLATE pg_catalog."C",
    result json,
    set_aside character varying COLLATE pg_catalog."C",
    compute_s double precision NOT NULL
);
CREATE TABLE public.visitor_runs (
    run_id character varying NOT NULL COLLATE pg_catalog."C",
    visitor character varying NOT NULL COLLATE pg_catalog."C",
    steps bigint NOT NULL,
    is_main boolean NOT NULL,
    created_at timestamp with time zone NOT NULL
);
INSERT INTO public.about VALUES ('8dca6bbb53b644b8', 1);
INSERT INTO public.alembic_version VALUES ('0010');
INSERT INTO public.artifacts VALUES ('0pmz0000a0001', 'q-table.npz', '513e04fe97b3b7358bdd864aa3c6fece', 1024, '785b0751fc2c53dc14a4ce3d800e69ef9ce1009eb327ccf458afe09c242c26c9', '2026-11-25 21:32:38.78256+00');
INSERT INTO public.evaluations VALUES ('0pmz0000a0001', 50, 0.125, 1);
INSERT INTO public.evaluations VALUES ('0pmz0000a0001', 100, -0.25, 0.9);
INSERT INTO public.runs VALUES ('0pmz0000a0002', 'training', 'training 0pmz0000a0002', 'failed', '{"gait": "left-right-origin", "robot": {"preset": "stiff"}, "simulator": "mujoco", "divisions": 2, "grid_side_m": 0.04, "disturbances": [], "tolerance": 0.0, "steps": 500, "seed": 0, "observation": "measured", "settings": {"alpha": 0.3, "gamma": 0.9, "epsilon_start": 1.0, "epsilon_end": 0.0}, "steps_per_episode": 50, "evaluate_every": 50, "pace": "max", "agent": "q-learning"}', '[]', '[]', '0pmz0000a0001', 0, 500, NULL, '[]', NULL, NULL, 'The physics diverged.', '2026-02-28 23:59:59.123456+00', NULL, NULL, NULL, '', '', NULL, false);
INSERT INTO public.runs VALUES ('0pmz0000a0003', 'race', 'race 0pmz0000a0003', 'stopped', '{"gait": "front-back-vertical", "robot": {"preset": "stiff"}, "simulator": "mujoco", "divisions": 2, "grid_side_m": 0.04, "disturbances": [], "tolerance": 0.0, "lanes": [{"agent": "q-learning", "observation": "commanded", "keep_learning": false, "plans_with": null, "settings": {}}, {"agent": "greedy", "observation": "measured", "keep_learning": false, "plans_with": null, "settings": {}}], "steps": 50, "seed": 0, "branch_from": null}', '["abc", null]', '[]', NULL, 0, 100, NULL, '[]', NULL, '{"lanes": [], "recording_sha256": null, "shared_machine": false}', NULL, '2026-02-28 23:59:59.123456+00', NULL, '2026-02-28 23:59:59.123456+00', NULL, '', '', NULL, false);
INSERT INTO public.runs VALUES ('0pmz0000a0004', 'experiment', 'experiment 0pmz0000a0004', 'interrupted', '{"experiment": "sweep", "seeds": 3, "seed": 1208925819614629174706176, "agents": ["q-learning", "my.module:Agent"], "gaits": ["left-right-origin", {"right_leg": 1, "left_leg": 4, "pairs": [[1, 4], [2, 6], [3, 5]]}], "observations": ["commanded"], "robots": [{"preset": "stiff"}, {"preset": "slippery", "legs": [{"azimuth_deg": 0.0, "radius_m": 0.12}, {"azimuth_deg": 60.0, "radius_m": 0.12}, {"azimuth_deg": 120.0, "radius_m": 0.12}, {"azimuth_deg": 180.0, "radius_m": 0.12}, {"azimuth_deg": 240.0, "radius_m": 0.12}, {"azimuth_deg": 300.0, "radius_m": 0.12}], "femur_m": 0.09}], "simulator": "kinematic", "steps": [500], "settings": {"alpha": [0.1, 0.3], "gamma": [0.9], "epsilon_start": [1.0], "epsilon_end": [0.0]}, "steps_per_episode": [50], "divisions": [2, 3], "grid_side_m": [0.04], "blocks": 1, "worlds": ["flat"], "tolerance": 0.0}', '[]', '[]', NULL, 2, 100, NULL, '[]', NULL, NULL, NULL, '2026-02-28 23:59:59.123456+00', NULL, '2026-02-28 23:59:59.123456+00', 2, '', '', NULL, false);
INSERT INTO public.runs VALUES ('0pmz0000a0001', 'training', 'Grüße, ''quoted'' \ and so on', 'finished', '{"gait": {"right_leg": 1, "left_leg": 4, "pairs": [[1, 4], [2, 6], [3, 5]]}, "robot": {"preset": "slippery", "legs": [{"azimuth_deg": 0.0, "radius_m": 0.12}, {"azimuth_deg": 60.0, "radius_m": 0.12}, {"azimuth_deg": 120.0, "radius_m": 0.12}, {"azimuth_deg": 180.0, "radius_m": 0.12}, {"azimuth_deg": 240.0, "radius_m": 0.12}, {"azimuth_deg": 300.0, "radius_m": 0.12}], "femur_m": 0.09}, "simulator": "kinematic", "divisions": 2, "grid_side_m": 0.04, "disturbances": [], "tolerance": 0.0, "steps": 500, "seed": 1208925819614629174706176, "observation": "measured", "settings": {"alpha": 0.3, "gamma": 0.9, "epsilon_start": 1.0, "epsilon_end": 0.0}, "steps_per_episode": 50, "evaluate_every": 50, "pace": 2.5, "agent": "my.module:Agent"}', '[]', '[]', NULL, 500, 500, NULL, '[{"step": 20, "settings": {"alpha": 0.1}}, {"step": 30, "pace": "max"}]', 0.4321, '{"distance_m": null, "greedy_distance_m": null, "best_known_m": null, "q_table_sha256": "abababababababababababababababababababababababababababababababab", "fell_at_step": null}', NULL, '2026-02-28 23:59:59.123456+00', '2026-03-01 00:00:00.123456+00', '2026-03-01 00:59:59.123456+00', NULL, '
Übung 1
kept
', 'Slips.
	Next: µ = 0.4', NULL, false);
INSERT INTO public.trials VALUES ('0pmz0000a0004', 'left-right-origin/commanded/stiff/greedy#0', '{"distances_m": [0.49666, -0.25], "finished_distance_m": null, "elapsed_s": 1.5, "transitions": 600, "wall": [{"agent": "greedy", "rank": 1}], "failure": null}', NULL, 0.0125);
INSERT INTO public.trials VALUES ('0pmz0000a0004', 'left-right-origin/commanded/stiff/q-learning/500/α=0.1#12', NULL, 'it ended its worker''s process 3 times', 0);
ALTER TABLE ONLY public.about
    ADD CONSTRAINT about_pkey PRIMARY KEY (id);
ALTER TABLE ONLY public.alembic_version
    ADD CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num);
ALTER TABLE ONLY public.artifacts
    ADD CONSTRAINT artifacts_file_key UNIQUE (file);
ALTER TABLE ONLY public.artifacts
    ADD CONSTRAINT artifacts_pkey PRIMARY KEY (run_id, name);
ALTER TABLE ONLY public.evaluations
    ADD CONSTRAINT evaluations_pkey PRIMARY KEY (run_id, step);
ALTER TABLE ONLY public.idempotency_keys
    ADD CONSTRAINT idempotency_keys_pkey PRIMARY KEY (key);
ALTER TABLE ONLY public.lessons
    ADD CONSTRAINT lessons_pkey PRIMARY KEY (id);
ALTER TABLE ONLY public.participants
    ADD CONSTRAINT participants_key_sha256_key UNIQUE (key_sha256);
ALTER TABLE ONLY public.participants
    ADD CONSTRAINT participants_pkey PRIMARY KEY (room, seed);
ALTER TABLE ONLY public.predictions
    ADD CONSTRAINT predictions_pkey PRIMARY KEY (room, seed, card);
ALTER TABLE ONLY public.robots
    ADD CONSTRAINT robots_pkey PRIMARY KEY (id);
ALTER TABLE ONLY public.room_runs
    ADD CONSTRAINT room_runs_pkey PRIMARY KEY (run_id);
ALTER TABLE ONLY public.rooms
    ADD CONSTRAINT rooms_pkey PRIMARY KEY (code);
ALTER TABLE ONLY public.runs
    ADD CONSTRAINT runs_pkey PRIMARY KEY (id);
ALTER TABLE ONLY public.sessions
    ADD CONSTRAINT sessions_pkey PRIMARY KEY (id_sha256);
ALTER TABLE ONLY public.tournament_entries
    ADD CONSTRAINT tournament_entries_pkey PRIMARY KEY (tournament, number);
ALTER TABLE ONLY public.tournament_judgements
    ADD CONSTRAINT tournament_judgements_pkey PRIMARY KEY (tournament, number, draw);
ALTER TABLE ONLY public.tournament_tables
    ADD CONSTRAINT tournament_tables_pkey PRIMARY KEY (tournament, sha256);
ALTER TABLE ONLY public.tournaments
    ADD CONSTRAINT tournaments_pkey PRIMARY KEY (id);
ALTER TABLE ONLY public.trials
    ADD CONSTRAINT trials_pkey PRIMARY KEY (run_id, key);
ALTER TABLE ONLY public.visitor_runs
    ADD CONSTRAINT visitor_runs_pkey PRIMARY KEY (run_id);
CREATE INDEX ix_idempotency_keys_created_at ON public.idempotency_keys USING btree (created_at);
CREATE INDEX ix_room_runs_room_card_seed ON public.room_runs USING btree (room, card, seed);
CREATE INDEX ix_runs_kind_id ON public.runs USING btree (kind, id);
CREATE INDEX ix_runs_kind_state_id ON public.runs USING btree (kind, state, id);
CREATE INDEX ix_runs_state_id ON public.runs USING btree (state, id);
CREATE INDEX ix_sessions_expires_at ON public.sessions USING btree (expires_at);
ALTER TABLE ONLY public.artifacts
    ADD CONSTRAINT artifacts_run_id_fkey FOREIGN KEY (run_id) REFERENCES public.runs(id) ON DELETE CASCADE;
ALTER TABLE ONLY public.evaluations
    ADD CONSTRAINT evaluations_run_id_fkey FOREIGN KEY (run_id) REFERENCES public.runs(id) ON DELETE CASCADE;
ALTER TABLE ONLY public.participants
    ADD CONSTRAINT participants_room_fkey FOREIGN KEY (room) REFERENCES public.rooms(code) ON DELETE CASCADE;
ALTER TABLE ONLY public.predictions
    ADD CONSTRAINT predictions_room_fkey FOREIGN KEY (room) REFERENCES public.rooms(code) ON DELETE CASCADE;
ALTER TABLE ONLY public.room_runs
    ADD CONSTRAINT room_runs_room_fkey FOREIGN KEY (room) REFERENCES public.rooms(code) ON DELETE CASCADE;
ALTER TABLE ONLY public.tournament_entries
    ADD CONSTRAINT tournament_entries_tournament_fkey FOREIGN KEY (tournament) REFERENCES public.tournaments(id) ON DELETE CASCADE;
ALTER TABLE ONLY public.tournament_judgements
    ADD CONSTRAINT tournament_judgements_tournament_fkey FOREIGN KEY (tournament) REFERENCES public.tournaments(id) ON DELETE CASCADE;
ALTER TABLE ONLY public.tournament_tables
    ADD CONSTRAINT tournament_tables_tournament_fkey FOREIGN KEY (tournament) REFERENCES public.tournaments(id) ON DELETE CASCADE;
ALTER TABLE ONLY public.trials
    ADD CONSTRAINT trials_run_id_fkey FOREIGN KEY (run_id) REFERENCES public.runs(id) ON DELETE CASCADE;
