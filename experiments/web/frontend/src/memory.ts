/** Remembering, in this browser, which session of a study is under way. */

import type { Credentials } from "./api";

/** Return the remembered session of a study, or null. */
export function recall(study: string): Credentials | null {
  try {
    return JSON.parse(localStorage.getItem(key(study)) ?? "null") as Credentials | null;
  } catch {
    return null; // storage refused or damaged: begin anew
  }
}

/** Remember a study's session; false where the browser refuses, and a reload then begins anew. */
export function remember(study: string, credentials: Credentials): boolean {
  try {
    localStorage.setItem(key(study), JSON.stringify(credentials));
    return true;
  } catch {
    return false;
  }
}

/** Forget a study's session. */
export function forget(study: string): void {
  try {
    localStorage.removeItem(key(study));
  } catch {
    // storage refused: nothing was remembered
  }
}

function key(study: string): string {
  return `trompe.session.${study}`;
}
