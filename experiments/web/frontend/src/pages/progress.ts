/** The counts of a study and the table of its sessions, for the researcher's page. */

import { element } from "../dom";
import { type MessageKey, message } from "../messages";

/** One participant's session. Times are ISO 8601. */
export interface SessionProgress {
  session: string;
  participant: string;
  started_at: string;
  answers: number;
  of: number;
  /** The share of trials with late frames, where it is known. */
  late_share: number | null;
  completed_at: string | null;
  withdrawn_at: string | null;
  /** Why the researcher left the session out, or null. */
  exclusion: string | null;
  simulated: boolean;
  pilot: boolean;
}

/** How far a study has come; `started` and `completed` count people only. */
export interface Progress {
  study: string;
  title: string;
  target: number;
  /** When the researcher paused the study, or null. */
  paused_since: string | null;
  /** Who is silent for so long, in seconds, counts as dropped out. */
  abandoned_after_s: number;
  started: number;
  completed: number;
  simulated_started: number;
  simulated_completed: number;
  pilot_started: number;
  dropped_out: number;
  excluded: number;
  withdrawn: number;
  answers: number;
  answers_by_hour: [hour: string, count: number][];
  last_answer_at: string | null;
  sessions: SessionProgress[];
}

/** What can be done with a session. */
export interface SessionActions {
  exclude(session: SessionProgress): void;
  withdraw(session: SessionProgress): void;
}

/** Return counts and table as elements. */
export function progressView(progress: Progress, actions: SessionActions): Node[] {
  const table =
    progress.sessions.length === 0
      ? element("p", { class: "hint" }, message("researcher.sessions.none"))
      : sessionTable(progress.sessions, actions);
  const note = element("p", { class: "simulated-note" }, message("researcher.simulated_note"));
  note.hidden = progress.simulated_started === 0;
  const time = overTime(progress.answers_by_hour);
  return [tiles(progress), ...time, note, element("h2", {}, message("researcher.sessions")), table];
}

function tiles(progress: Progress): HTMLElement {
  const last = progress.last_answer_at;
  return element(
    "dl",
    { class: "tiles" },
    tile("researcher.completed", progress.completed, {
      key: "researcher.completed.of",
      values: { target: progress.target },
    }),
    tile("researcher.started", progress.started),
    tile("researcher.dropped_out", progress.dropped_out, {
      key: "researcher.dropped_out.of",
      values: { minutes: Math.round(progress.abandoned_after_s / 60) },
    }),
    tile("researcher.left_out", progress.excluded, {
      key: "researcher.left_out.of",
      values: { withdrawn: progress.withdrawn },
    }),
    tile("researcher.answers", progress.answers),
    tile("researcher.last_answer", last === null ? message("researcher.none_yet") : clock(last)),
    tile("researcher.simulated", progress.simulated_completed, {
      key: "researcher.simulated.of",
      values: { started: progress.simulated_started },
    }),
    tile("researcher.pilot", progress.pilot_started),
  );
}

function tile(
  name: MessageKey,
  value: string | number,
  of?: { key: MessageKey; values?: Record<string, number> },
): HTMLElement {
  const number = element("dd", {}, String(value));
  if (of !== undefined) {
    number.append(" ", element("small", {}, message(of.key, of.values)));
  }
  return element("div", {}, element("dt", {}, message(name)), number);
}

const SHOWN_HOURS = 72;
const SVG = "http://www.w3.org/2000/svg";

/** Bars of the answers in each hour, up to the last one in which one came. */
function overTime(byHour: [hour: string, count: number][]): Node[] {
  const last = byHour.at(-1);
  if (last === undefined) {
    return [];
  }
  const end = Date.parse(last[0]);
  const most = Math.max(...byHour.map(([, count]) => count));
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("class", "over-time");
  svg.setAttribute("viewBox", `0 0 ${SHOWN_HOURS} 20`);
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", message("researcher.over_time"));
  for (const [hour, count] of byHour) {
    const back = (end - Date.parse(hour)) / 3_600_000;
    if (back < SHOWN_HOURS) {
      svg.append(bar(SHOWN_HOURS - 1 - back, (20 * count) / most, hour, count));
    }
  }
  return [element("h2", {}, message("researcher.over_time")), svg];
}

function bar(x: number, height: number, hour: string, count: number): SVGElement {
  const rectangle = document.createElementNS(SVG, "rect");
  const place = { x: x + 0.1, y: 20 - height, width: 0.8, height };
  for (const [name, value] of Object.entries(place)) {
    rectangle.setAttribute(name, String(value));
  }
  const title = document.createElementNS(SVG, "title");
  title.append(message("researcher.over_time.bar", { time: clock(hour), count }));
  rectangle.append(title);
  return rectangle;
}

const COLUMNS = [
  "participant",
  "kind",
  "started",
  "answers",
  "completed",
  "late",
  "action",
] as const;

/** The newest session first. */
function sessionTable(sessions: SessionProgress[], actions: SessionActions): HTMLElement {
  const head = COLUMNS.map((column) =>
    element("th", { scope: "col" }, message(`researcher.column.${column}`)),
  );
  const table = element(
    "table",
    {},
    element("thead", {}, element("tr", {}, ...head)),
    element("tbody", {}, ...sessions.map((each) => sessionRow(each, actions)).reverse()),
  );
  return element("div", { class: "table" }, table);
}

function sessionRow(session: SessionProgress, actions: SessionActions): HTMLElement {
  const kind = session.simulated ? "simulated" : session.pilot ? "pilot" : "person";
  const bar = element("progress", { max: String(session.of), value: String(session.answers) });
  bar.setAttribute("aria-hidden", "true");
  return element(
    "tr",
    { class: kind },
    element("th", { scope: "row" }, session.participant),
    element("td", {}, element("span", { class: "kind" }, message(`researcher.kind.${kind}`))),
    element("td", {}, clock(session.started_at)),
    element("td", {}, `${session.answers} / ${session.of}`, bar),
    element("td", {}, session.completed_at === null ? "–" : clock(session.completed_at)),
    element("td", {}, session.late_share === null ? "–" : percent(session.late_share)),
    element("td", {}, ...standing(session, actions)),
  );
}

/** Whether a session no longer counts, or what can be done with it. */
function standing(session: SessionProgress, actions: SessionActions): (Node | string)[] {
  if (session.withdrawn_at !== null) {
    return [message("researcher.kind.withdrawn")];
  }
  const withdraw = action("researcher.withdraw", session, () => actions.withdraw(session));
  if (session.exclusion !== null) {
    const reason = { title: session.exclusion };
    return [element("span", reason, message("researcher.kind.excluded")), " ", withdraw];
  }
  return [action("researcher.exclude", session, () => actions.exclude(session)), " ", withdraw];
}

function action(key: MessageKey, { participant }: SessionProgress, run: () => void) {
  const label = `${message(key)} ${participant}`;
  const button = element("button", { type: "button", "aria-label": label }, message(key));
  button.addEventListener("click", run);
  return button;
}

function percent(share: number): string {
  return share.toLocaleString([], { style: "percent", maximumFractionDigits: 1 });
}

/** The time of day, with the date where it is not today. */
export function clock(iso: string): string {
  const moment = new Date(iso);
  const today = moment.toDateString() === new Date().toDateString();
  const date: Intl.DateTimeFormatOptions = today ? {} : { dateStyle: "medium" };
  return moment.toLocaleString([], { timeStyle: "short", ...date });
}
