/** One page at a time: the same study runs in no second tab, the same session in no second browser. */

import { api, type Credentials, sessionPath } from "./api";
import { drawId } from "./random";
import { ApiError, retry } from "./retry";

/** A page that is reloaded takes its lock again within this. */
const RELOAD_S = 3;
const MOMENT_S = 0.5;
const TRY_AGAIN_S = 2;
/** Several times within what the server takes for silence (`LEASE_S` in experiments/storage/leases.py). */
const RENEW_S = 12;
const NAME_KEY = "trompe.page";

/**
 * Wait until no other tab of this browser has the study open.
 *
 * Where browsers have no locks (on plain HTTP), the server's lease alone keeps others out.
 *
 * @param onElsewhere - Called if another tab has it.
 */
export async function holdStudy(study: string, onElsewhere: () => void): Promise<void> {
  const { locks } = navigator as { locks?: LockManager };
  if (locks === undefined) {
    return;
  }
  const name = `trompe.${study}`;
  while (!(await takeLock(locks, name))) {
    onElsewhere();
    // Free at two looks in a row: the first tab was closed, and not reloaded.
    for (let free = 0; free < 2; free = (await isFree(locks, name)) ? free + 1 : 0) {
      await delay(RELOAD_S);
    }
  }
}

/** Take a lock for as long as the page stays; false if another page keeps it. */
function takeLock(locks: LockManager, name: string): Promise<boolean> {
  // The page that a reload replaces may have it for a moment.
  const signal = AbortSignal.timeout(1000 * MOMENT_S);
  return new Promise((resolve) => {
    const taken = () => {
      resolve(true);
      return new Promise(() => {});
    };
    locks.request(name, { signal }, taken).catch(() => resolve(false));
  });
}

async function isFree(locks: LockManager, name: string): Promise<boolean> {
  const { held = [] } = await locks.query();
  return held.every((lock) => lock.name !== name);
}

function delay(time_s: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, 1000 * time_s));
}

/**
 * Wait until the server gives this page the session, and keep it from then on.
 *
 * @param onElsewhere - Called while another page has it.
 * @param onLost - Called if, after this page was not heard of for long, another page got it.
 * @throws ApiError if the server does not know the session.
 */
export async function keepSession(
  credentials: Credentials,
  onElsewhere: () => void,
  onLost: () => void,
): Promise<void> {
  const page = takeName();
  while (!(await renew(credentials, page))) {
    onElsewhere();
    await delay(TRY_AGAIN_S);
  }
  const timer = setInterval(async () => {
    const kept = await renew(credentials, page).catch(() => true); // the session itself has ended
    if (!kept) {
      clearInterval(timer);
      onLost();
    }
  }, 1000 * RENEW_S);
  window.addEventListener("pagehide", () => leave(credentials, page));
  // A page that the browser had put aside has given its session away.
  window.addEventListener("pageshow", ({ persisted }) => persisted && location.reload());
}

/** Return whether this page has the session. */
async function renew(credentials: Credentials, page: string): Promise<boolean> {
  try {
    await retry(() => api.keep(credentials, page));
    return true;
  } catch (error) {
    if (error instanceof ApiError && error.code === "open-elsewhere") {
      return false;
    }
    throw error;
  }
}

/** Tell the server, and the page that a reload makes of this one. */
function leave({ session, token }: Credentials, page: string): void {
  try {
    sessionStorage.setItem(NAME_KEY, page);
  } catch {
    // storage refused: a reload waits until the server takes this page for gone
  }
  void fetch(`${sessionPath(session)}/lease/end`, {
    method: "POST",
    keepalive: true,
    headers: { "Content-Type": "application/json", Authorization: `Bearer ${token}` },
    body: JSON.stringify({ page }),
  }).catch(() => {});
}

/**
 * Return what this page calls itself: after a reload the same as before.
 *
 * The name lies in the tab's storage only while no page is shown: a copy of the tab has none.
 */
function takeName(): string {
  try {
    const name = sessionStorage.getItem(NAME_KEY);
    sessionStorage.removeItem(NAME_KEY);
    return name ?? drawId();
  } catch {
    return drawId();
  }
}
