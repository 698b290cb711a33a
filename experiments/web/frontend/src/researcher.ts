/** The researcher's page: live counts, and the answers as a file. */

import { getBlob, getJson, post } from "./api";
import { element } from "./dom";
import { type MessageKey, message, setLanguage } from "./messages";
import { clock, type Progress, progressView, type SessionProgress } from "./pages/progress";
import { ApiError } from "./retry";
import "./styles/base.css";
import "./styles/pages.css";
import "./styles/researcher.css";

setLanguage(navigator.language);

const POLL_S = 2;

const study = /^\/researcher\/([^/]+)/.exec(location.pathname)?.[1] ?? "";
const path = `/api/researcher/${study}`;
const state = element("p", { class: "hint", role: "status" });
const counts = element("div", { class: "counts" });
const download = element(
  "button",
  { class: "primary", type: "button" },
  message("researcher.download"),
);
/** What else can be saved, by the message on its button. */
const TABLES: [MessageKey, string][] = [
  ["researcher.save.parquet", "responses.parquet"],
  ["researcher.save.sessions", "sessions.csv"],
  ["researcher.save.events", "events.csv"],
];
const saves = element(
  "div",
  { class: "saves" },
  download,
  ...TABLES.map(([key, file]) => {
    const button = element("button", { type: "button" }, message(key));
    button.addEventListener("click", () => void save(file));
    return button;
  }),
);
const link = element(
  "p",
  { class: "hint" },
  message("researcher.link", { link: `${location.origin}/s/${study}/` }),
);
const pausing = element("button", { type: "button" });
const paused = element("p", { class: "paused" });
const fault = element("p", { class: "fault", role: "alert" });
const heading = element("h1", {}, message("researcher.title", { study }));
const main = element(
  "main",
  { class: "page researcher" },
  heading,
  state,
  element("div", { class: "saves" }, pausing, paused),
  counts,
  saves,
  fault,
  link,
);

document.body.append(main);
document.title = message("researcher.title", { study });
download.addEventListener("click", () => void save("responses.csv"));
// Another link pasted into the open page changes the fragment without loading it again.
window.addEventListener("hashchange", () => location.reload());
void follow();

function token(): string {
  return decodeURIComponent(location.hash.slice(1));
}

/** Show the counts again and again, until the server refuses the token. */
async function follow(): Promise<void> {
  try {
    const progress = await getJson<Progress>(path, token());
    counts.replaceChildren(...progressView(progress, { exclude, withdraw }));
    heading.textContent = progress.title;
    showPause(progress.paused_since);
    state.textContent = message("researcher.updated", { time: new Date().toLocaleTimeString() });
    main.classList.remove("stale");
  } catch (error) {
    if (error instanceof ApiError && error.status < 500) {
      refuse(error);
      return;
    }
    state.textContent = message("researcher.unreachable");
    main.classList.add("stale");
  }
  setTimeout(() => void follow(), 1000 * POLL_S);
}

function refuse(error: ApiError): void {
  const key = error.status === 404 ? "researcher.unknown_study" : "researcher.token";
  main.replaceChildren(heading, element("p", { class: "fault", role: "alert" }, message(key)));
}

function showPause(since: string | null): void {
  const key = since === null ? "researcher.pause" : "researcher.resume";
  pausing.textContent = message(key);
  pausing.onclick = () => void tell(since === null ? "pause" : "resume", null);
  paused.textContent = since === null ? "" : message("researcher.paused", { time: clock(since) });
}

function exclude(session: SessionProgress): void {
  const { participant } = session;
  const reason = window.prompt(message("researcher.exclude.reason", { participant }))?.trim();
  if (reason) {
    void change(session, "exclusion", { reason });
  }
}

function withdraw(session: SessionProgress): void {
  const { participant } = session;
  if (window.confirm(message("researcher.withdraw.sure", { participant }))) {
    void change(session, "withdrawal", null);
  }
}

function change({ session }: SessionProgress, what: string, body: unknown): Promise<void> {
  return tell(`sessions/${encodeURIComponent(session)}/${what}`, body);
}

/** Tell the server; the next counts show what came of it. */
async function tell(what: string, body: unknown): Promise<void> {
  fault.textContent = "";
  try {
    await post(`${path}/${what}`, token(), body);
  } catch (error) {
    const reason = error instanceof Error ? error.message : String(error);
    fault.textContent = message("researcher.action_failed", { reason });
  }
}

async function save(file: string): Promise<void> {
  fault.textContent = "";
  try {
    // Fetched, not linked: a link would carry the token in the address and so into logs.
    const address = URL.createObjectURL(await getBlob(`${path}/${file}`, token()));
    element("a", { href: address, download: `${study}-${file}` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 60_000);
  } catch (error) {
    const reason = error instanceof Error ? error.message : String(error);
    fault.textContent = message("researcher.download_failed", { reason });
  }
}
