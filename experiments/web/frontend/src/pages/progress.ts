/** The counts of a study and the table of its sessions, for the researcher's page. */

import { element } from "../dom";
import { type MessageKey, message } from "../messages";

/** One participant's session. Times are ISO 8601. */
export interface SessionProgress {
  participant: string;
  started_at: string;
  answers: number;
  of: number;
  completed_at: string | null;
  simulated: boolean;
  pilot: boolean;
}

/** How far a study has come; `started` and `completed` count people only. */
export interface Progress {
  study: string;
  title: string;
  target: number;
  started: number;
  completed: number;
  simulated_started: number;
  simulated_completed: number;
  pilot_started: number;
  answers: number;
  last_answer_at: string | null;
  sessions: SessionProgress[];
}

/** Return counts and table as elements. */
export function progressView(progress: Progress): Node[] {
  const table =
    progress.sessions.length === 0
      ? element("p", { class: "hint" }, message("researcher.sessions.none"))
      : sessionTable(progress.sessions);
  const note = element("p", { class: "simulated-note" }, message("researcher.simulated_note"));
  note.hidden = progress.simulated_started === 0;
  return [tiles(progress), note, element("h2", {}, message("researcher.sessions")), table];
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
  of?: { key: MessageKey; values: Record<string, number> },
): HTMLElement {
  const number = element("dd", {}, String(value));
  if (of !== undefined) {
    number.append(" ", element("small", {}, message(of.key, of.values)));
  }
  return element("div", {}, element("dt", {}, message(name)), number);
}

const COLUMNS = ["participant", "kind", "started", "answers", "completed"] as const;

/** The newest session first. */
function sessionTable(sessions: SessionProgress[]): HTMLElement {
  const head = COLUMNS.map((column) =>
    element("th", { scope: "col" }, message(`researcher.column.${column}`)),
  );
  const table = element(
    "table",
    {},
    element("thead", {}, element("tr", {}, ...head)),
    element("tbody", {}, ...sessions.map(sessionRow).reverse()),
  );
  return element("div", { class: "table" }, table);
}

function sessionRow(session: SessionProgress): HTMLElement {
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
  );
}

/** The time of day, with the date where it is not today. */
function clock(iso: string): string {
  const moment = new Date(iso);
  const today = moment.toDateString() === new Date().toDateString();
  const date: Intl.DateTimeFormatOptions = today ? {} : { dateStyle: "medium" };
  return moment.toLocaleString([], { timeStyle: "short", ...date });
}
