/** Finding the study and the session under way, or opening a new session. */

import { api, type Closed, type Credentials, type NewSession, type Study } from "./api";
import { describeDevice, describeScreen } from "./device";
import { watchFrames } from "./frames";
import { forget, recall, remember } from "./memory";
import { message } from "./messages";
import { calibrate } from "./pages/calibration";
import { showConsent } from "./pages/consent";
import { askDemographics } from "./pages/demographics";
import { showClosed, showConnecting, showProblem } from "./pages/problem";
import { drawId } from "./random";
import { recruitmentOf, tellsWho } from "./recruitment";
import { ApiError, retry } from "./retry";

/** Return a study, or null if there is none of that name. */
export async function findStudy(root: HTMLElement, name: string): Promise<Study | null> {
  try {
    return await retry(
      () => api.study(name),
      () => showConnecting(root),
    );
  } catch (error) {
    if (error instanceof ApiError && error.status === 404) {
      return null;
    }
    throw error;
  }
}

/** On a computer that several people use, `?new` in the address begins with the next one. */
export function leaveIfAsked(name: string): void {
  const given = new URLSearchParams(location.search);
  if (given.has("new")) {
    forget(name);
    given.delete("new");
    const rest = given.size === 0 ? "" : `?${given}`;
    history.replaceState(null, "", location.pathname + rest);
  }
}

/** Return the session that this browser, or who comes by this link, began earlier, or null. */
export async function findSession(root: HTMLElement, study: Study): Promise<Credentials | null> {
  const recruitment = recruitmentOf(study);
  if (!tellsWho(study, recruitment)) {
    return recall(study.study);
  }
  try {
    return await retry(
      () => api.comeBack(study.study, recruitment),
      () => showConnecting(root),
    );
  } catch (error) {
    if (error instanceof ApiError && error.status === 404) {
      return null;
    }
    throw error;
  }
}

/** Ask for consent and demographics and open a session; null where the server takes nobody. */
export async function beginSession(root: HTMLElement, study: Study): Promise<Credentials | null> {
  if (study.closed !== null) {
    showClosed(root, study.closed);
    return null;
  }
  const recruitment = recruitmentOf(study);
  if (study.recruitment.required && !tellsWho(study, recruitment)) {
    showProblem(root, message("problem.recruitment"));
    return null;
  }
  const watch = watchFrames();
  await showConsent(root, study);
  const { interval_s } = watch.stop();
  const demographics =
    study.demographics.length === 0 ? {} : await askDemographics(root, study.demographics);
  const calibration = await calibrate(root, study.screen);
  const refresh = interval_s === null ? {} : { refresh_hz: Math.round(10 / interval_s) / 10 };
  const wanted: NewSession = {
    consent_version: study.consent.version,
    demographics,
    screen: { ...describeScreen(), ...refresh, ...calibration },
    device: describeDevice(navigator.userAgent),
    arrival: drawId(),
    recruitment,
    simulated: false,
  };
  try {
    const { session, token } = await retry(
      () => api.begin(study.study, wanted),
      () => showConnecting(root),
    );
    remember(study.study, { session, token });
    return { session, token };
  } catch (error) {
    if (error instanceof ApiError) {
      showRefusal(root, error);
      return null;
    }
    throw error;
  }
}

function showRefusal(root: HTMLElement, error: ApiError): void {
  const closed: Record<string, Closed> = { paused: "paused", full: "full", busy: "busy" };
  const why = closed[error.code];
  if (why === undefined) {
    showProblem(root, message("problem.refused", { reason: error.message }));
  } else {
    showClosed(root, why);
  }
}
