/** The participant's page: from consent to thanks, or from where an earlier visit stopped. */

import { initJsPsych } from "jspsych";
import { api, type Credentials, type Session, type Study } from "./api";
import { element } from "./dom";
import { enterFullscreen, leaveFullscreen } from "./fullscreen";
import { growTimeline } from "./growing-timeline";
import { forget } from "./memory";
import { message, setLanguage } from "./messages";
import { Notice } from "./notice";
import { beginSession, findSession, findStudy, leaveIfAsked } from "./opening";
import { holdStudy, keepSession } from "./page-lock";
import { showElsewhere } from "./pages/elsewhere";
import { type Example, showInstructions } from "./pages/instructions";
import { showLoading } from "./pages/loading";
import { showConnecting, showProblem } from "./pages/problem";
import { showResume } from "./pages/resume";
import { showSending, showThanks } from "./pages/thanks";
import { apiLoader, preload, preloadPictures } from "./preload";
import { Recorder } from "./recorder";
import { ApiError, retry } from "./retry";
import { makeTimeline } from "./timeline";
import { offerWithdrawal } from "./withdrawal";
import "./styles/base.css";
import "./styles/pages.css";
import "./styles/trial.css";

const root = element("div", { id: "page" });
document.body.append(root);
const notice = new Notice(document.body);

setLanguage(navigator.language); // until the study says its own
takePart(studyName(location.pathname)).catch((error: unknown) => {
  const reason = error instanceof Error ? error.message : String(error);
  showProblem(root, message("problem.unexpected", { reason }));
});

async function takePart(name: string): Promise<void> {
  const study = await findStudy(root, name);
  if (study === null) {
    showProblem(root, message("problem.unknown_study"));
    return;
  }
  document.title = study.title;
  document.documentElement.lang = study.language;
  setLanguage(study.language);
  leaveIfAsked(name);
  await holdStudy(name, () => showElsewhere(root));
  const earlier = await findSession(root, study);
  if (earlier !== null && (await takeSession(study, earlier))) {
    await continueSession(study, earlier, true);
    return;
  }
  const begun = await beginSession(root, study);
  if (begun !== null && (await takeSession(study, begun))) {
    await continueSession(study, begun, false);
  }
}

/** Take a session for this page alone; false where the server does not know it any more. */
async function takeSession({ study }: Study, credentials: Credentials): Promise<boolean> {
  try {
    await keepSession(
      credentials,
      () => showElsewhere(root),
      () => location.reload(),
    );
    return true;
  } catch (error) {
    if (error instanceof ApiError) {
      forget(study);
      return false;
    }
    throw error;
  }
}

/** @param returning - Whether the session was begun by an earlier page. */
async function continueSession(
  study: Study,
  credentials: Credentials,
  returning: boolean,
): Promise<void> {
  let session = await retry(() => api.session(credentials));
  const { adaptive } = session;
  const offline = adaptive === null ? "notice.offline" : "notice.offline_wait";
  const recorder = await Recorder.open(credentials, notice, offline);
  offerWithdrawal(root, study.study, credentials, () => recorder.close());
  if (session.completion_code !== null) {
    const { completion_code, completion_url } = session;
    showThanks(root, { completion_code, completion_url }, false);
    return;
  }
  if (adaptive !== null && recorder.unsentTrials().length > 0) {
    // What comes next follows from the answers that an earlier page left unsent.
    showConnecting(root);
    await recorder.allSent();
    session = await retry(() => api.session(credentials));
  }
  const answered = new Set([...session.answered, ...recorder.unsentTrials()]);
  const unanswered = session.trials.filter((trial) => !answered.has(trial.index));
  if (returning) {
    recorder.event("resume", { answered: answered.size });
    await showResume(root, answered.size, session);
  } else {
    await instruct(study, session);
  }
  if (study.screen.fullscreen) {
    recorder.event("fullscreen", { on: await enterFullscreen() });
  }
  const loader = apiLoader(credentials.token);
  const { moved, failed } = showLoading(root);
  if (adaptive === null) {
    const stimuli = await preload(unanswered, loader, moved, failed);
    await runTrials(() => makeTimeline(study, session.trials, stimuli, recorder), recorder);
  } else if (unanswered[0] !== undefined) {
    const [first] = unanswered;
    const stimuli = await preloadPictures(adaptive.pictures, loader, moved, failed);
    const grow = (display: () => HTMLElement) =>
      growTimeline(study, first, adaptive, stimuli, recorder, display);
    await runTrials(grow, recorder);
  }
  await leaveFullscreen();
  await finish(credentials, recorder);
}

async function instruct(study: Study, session: Session): Promise<void> {
  const practice = session.trials.some((trial) => trial.phase === "practice");
  await showInstructions(root, study, await loadExample(study), practice);
}

async function loadExample({ example }: Study): Promise<Example | null> {
  if (example === null) {
    return null;
  }
  const loaded = await preload([{ index: 0, pictures: [example] }], apiLoader(null));
  const stimulus = loaded.get(0)?.[0];
  return stimulus === undefined ? null : { stimulus, answer: example.answer };
}

async function runTrials(
  make: (display: () => HTMLElement) => ReturnType<typeof makeTimeline>,
  recorder: Recorder,
): Promise<void> {
  const jsPsych = initJsPsych({ display_element: root, use_webaudio: false });
  const timeline = make(() => jsPsych.getDisplayElement());
  if (timeline.length === 0) {
    return;
  }
  const watching = new AbortController();
  recorder.watchWindow(watching.signal);
  root.replaceChildren();
  await jsPsych.run(timeline);
  watching.abort();
}

/** Wait for the acknowledgement of every answer; only then is the session complete. */
async function finish(credentials: Credentials, recorder: Recorder): Promise<void> {
  showSending(root);
  await recorder.allSent();
  try {
    showThanks(root, await retry(() => api.complete(credentials)), true);
  } catch (error) {
    if (!(error instanceof ApiError)) {
      throw error;
    }
    const missing = (error.body as { missing?: number[] } | null)?.missing?.length ?? 0;
    const { session } = credentials;
    showProblem(root, message("problem.incomplete", { missing, session }));
  }
}

function studyName(path: string): string {
  return /^\/s\/([^/]+)/.exec(path)?.[1] ?? "";
}
