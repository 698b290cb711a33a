/** The researcher's page: live counts, and the answers as a file. */

import { getBlob, getJson } from "./api";
import { element } from "./dom";
import { message } from "./messages";
import { type Progress, progressView } from "./pages/progress";
import { ApiError } from "./retry";
import "./styles/base.css";
import "./styles/pages.css";
import "./styles/researcher.css";

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
const link = element(
  "p",
  { class: "hint" },
  message("researcher.link", { link: `${location.origin}/s/${study}/` }),
);
const fault = element("p", { class: "fault", role: "alert" });
const heading = element("h1", {}, message("researcher.title", { study }));
const main = element(
  "main",
  { class: "page researcher" },
  heading,
  state,
  counts,
  download,
  fault,
  link,
);

document.body.append(main);
document.title = message("researcher.title", { study });
download.addEventListener("click", () => void saveAnswers());
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
    counts.replaceChildren(...progressView(progress));
    heading.textContent = progress.title;
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

async function saveAnswers(): Promise<void> {
  fault.textContent = "";
  try {
    // Fetched, not linked: a link would carry the token in the address and so into logs.
    const address = URL.createObjectURL(await getBlob(`${path}/responses.csv`, token()));
    element("a", { href: address, download: `${study}-responses.csv` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 60_000);
  } catch (error) {
    const reason = error instanceof Error ? error.message : String(error);
    fault.textContent = message("researcher.download_failed", { reason });
  }
}
