/** Finding the study and the session under way, or opening a new session. */

import { api, type Credentials, type NewSession, type Session, type Study } from "./api";
import { describeDevice, describeScreen } from "./device";
import { forget, recall, remember } from "./memory";
import { message } from "./messages";
import { showConsent } from "./pages/consent";
import { askDemographics } from "./pages/demographics";
import { showConnecting, showProblem } from "./pages/problem";
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
  if (new URLSearchParams(location.search).has("new")) {
    forget(name);
    history.replaceState(null, "", location.pathname);
  }
}

/** Return the session that this browser began earlier, if the server still knows it. */
export async function findSession(
  root: HTMLElement,
  name: string,
): Promise<{ credentials: Credentials; session: Session } | null> {
  const credentials = recall(name);
  if (credentials === null) {
    return null;
  }
  try {
    const session = await retry(
      () => api.session(credentials),
      () => showConnecting(root),
    );
    return { credentials, session };
  } catch (error) {
    if (error instanceof ApiError) {
      forget(name);
      return null;
    }
    throw error;
  }
}

/** Ask for consent and demographics and open a session; null where the server takes nobody. */
export async function beginSession(root: HTMLElement, study: Study): Promise<Credentials | null> {
  if (!study.accepting) {
    showProblem(root, message("problem.closed"));
    return null;
  }
  await showConsent(root, study);
  const demographics =
    study.demographics.length === 0 ? {} : await askDemographics(root, study.demographics);
  const wanted: NewSession = {
    consent_version: study.consent.version,
    demographics,
    screen: describeScreen(),
    device: describeDevice(navigator.userAgent),
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
      showProblem(root, message("problem.refused", { reason: error.message }));
      return null;
    }
    throw error;
  }
}
