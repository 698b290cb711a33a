/** The participant's page: from consent to thanks, or from where an earlier visit stopped. */

import { initJsPsych } from "jspsych";
import { api, type Credentials, type Session, type Study } from "./api";
import { element } from "./dom";
import { growTimeline } from "./growing-timeline";
import { message, setLanguage } from "./messages";
import { Notice } from "./notice";
import { beginSession, findSession, findStudy, leaveIfAsked } from "./opening";
import { type Example, showInstructions } from "./pages/instructions";
import { showLoading } from "./pages/loading";
import { showConnecting, showProblem } from "./pages/problem";
import { showResume } from "./pages/resume";
import { showSending, showThanks } from "./pages/thanks";
import { apiLoader, preload, preloadPictures } from "./preload";
import { Recorder } from "./recorder";
import { ApiError, retry } from "./retry";
import { makeTimeline } from "./timeline";
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
  const earlier = await findSession(root, name);
  const credentials = earlier?.credentials ?? (await beginSession(root, study));
  if (credentials !== null) {
    await continueSession(study, credentials, earlier?.session ?? null);
  }
}

/** @param earlier - The session as a returning participant left it, or null for a new one. */
async function continueSession(
  study: Study,
  credentials: Credentials,
  earlier: Session | null,
): Promise<void> {
  let session = earlier ?? (await retry(() => api.session(credentials)));
  if (session.completion_code !== null) {
    showThanks(root, session.completion_code);
    return;
  }
  const { adaptive } = session;
  const offline = adaptive === null ? "notice.offline" : "notice.offline_wait";
  const recorder = await Recorder.open(credentials, notice, offline);
  if (adaptive !== null && recorder.unsentTrials().length > 0) {
    // What comes next follows from the answers that an earlier page left unsent.
    showConnecting(root);
    await recorder.allSent();
    session = await retry(() => api.session(credentials));
  }
  const answered = new Set([...session.answered, ...recorder.unsentTrials()]);
  const open = session.trials.filter((trial) => !answered.has(trial.index));
  if (earlier !== null) {
    recorder.event("resume", { answered: answered.size });
    await showResume(root, answered.size, session);
  } else {
    await instruct(study, session);
  }
  const loader = apiLoader(credentials.token);
  if (adaptive === null) {
    const stimuli = await preload(open, loader, showLoading(root));
    await runTrials(() => makeTimeline(study, session.trials, stimuli, recorder), recorder);
  } else if (open[0] !== undefined) {
    const [first] = open;
    const stimuli = await preloadPictures(adaptive.pictures, loader, showLoading(root));
    const grow = (display: () => HTMLElement) =>
      growTimeline(study, first, adaptive, stimuli, recorder, display);
    await runTrials(grow, recorder);
  }
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
    const { completion_code } = await retry(() => api.complete(credentials));
    showThanks(root, completion_code);
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
