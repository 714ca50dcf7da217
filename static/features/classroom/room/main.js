// Entry point of a room's page: by role the phone of a participant, the teacher's cockpit, or the projector.
import { effect, untracked } from "@preact/signals";
import { render } from "preact";
import { t } from "../../../js/format.js";
import { html } from "../../../js/components/elements.js";
import { Loaded, withStyle } from "../../../js/features.js";
import { followTheme } from "../../../js/page.js";
import { connection } from "../../../js/store.js";
import { Phone } from "./phone.js";
import { followRoom, isBeside, isProjector, isTeacher, isTeaching, refusal, refresh, replayed, room } from "./room.js";
import { Closed, Waiting } from "./join.js";

function Page() {
  if (room.value === null) return refusal.value ? html`<${Closed} />` : html`<${Waiting} />`;
  if (isBeside) return html`<${Loaded} name="robot" load=${loadBeside} />`;
  if (isProjector) return html`<${Loaded} name="projector" load=${loadProjector} />`;
  return isTeacher.value ? html`<${Loaded} name="cockpit" load=${loadCockpit} />` : html`<${Phone} />`;
}

// A class of phones needs neither.
const STYLE = "features/classroom/style";
// The inner style is the first in the page: that of a card that teaches changes what the projector's says.
const loadProjector = () => withStyle(`${STYLE}/teach.css`,
  withStyle(`${STYLE}/room-projector.css`, import("./projector.js"))).then(({ Projector }) => Projector);
const loadBeside = () => withStyle(`${STYLE}/teach.css`, import("./beside.js"))
  .then(({ Beside }) => Beside);
const loadCockpit = () => import("./cockpit.js").then(({ Cockpit }) => Cockpit);

followTheme();
document.documentElement.toggleAttribute("data-projector", isProjector);
effect(() => {
  const { title, code } = room.value ?? { title: t("Room"), code: "" };
  document.title = [code, title, "Racing Hexapods"].filter(Boolean).join(" · ");
});
let hasPicture = false;
// Who has nothing to see loads nothing that plays; if that fails, again once the connection is back.
effect(() => {
  const hasNothing = isBeside || (!isProjector && !isTeaching.value && replayed.value === null);
  if (hasPicture || connection.value !== "live" || hasNothing) return;
  hasPicture = true;
  import("./picture.js").then(({ followPicture }) => untracked(followPicture), () => (hasPicture = false));
});
// The frame of the robot beside the one of the class plays what its projector tells it, and nothing else.
if (isBeside) {
  connection.value = "live";
  refresh();
} else followRoom();

const root = /** @type {HTMLElement} */ (document.getElementById("app"));
root.replaceChildren();
render(html`<${Page} />`, root);
