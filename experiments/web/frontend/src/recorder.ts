/** Sends what happens in a session: answers and events, each through the outbox. */

import {
  type AnswerReply,
  answerId,
  type Credentials,
  post as postToServer,
  sessionPath,
} from "./api";
import type { TrialData } from "./asked";
import { describeWindow } from "./device";
import type { MessageKey } from "./messages";
import type { Notice } from "./notice";
import { Outbox } from "./outbox";
import { ApiError } from "./retry";
import { openPostStore, type Post, type PostStore } from "./storage";

type Detail = Record<string, string | number | boolean | null>;

/** Keeps and sends one session's answers and events. */
export class Recorder {
  private readonly outbox: Outbox;
  private eventCount = 0;
  private toldNotKept = false;
  private closed = false;

  private constructor(
    private readonly credentials: Credentials,
    private readonly notice: Notice,
    store: PostStore,
    offline: MessageKey,
  ) {
    this.outbox = new Outbox(store, (post) => postToServer(post.path, post.token, post.body), {
      onWaiting: (waiting) => notice.show(waiting ? offline : null),
      onRefused: (post, error) => this.refused(post, error),
      onNotKept: () => this.notKept(),
    });
  }

  /**
   * Open the outbox, and take up what earlier pages left unsent.
   *
   * @param offline - What is said while nothing can be sent.
   */
  static async open(
    credentials: Credentials,
    notice: Notice,
    offline: MessageKey = "notice.offline",
  ): Promise<Recorder> {
    const store = await openPostStore();
    const recorder = new Recorder(credentials, notice, store, offline);
    await recorder.outbox.resume();
    if (!store.persistent) {
      recorder.notKept();
    }
    return recorder;
  }

  /** Keep and send an answer; resolves when it is kept, with the promise of the server's reply. */
  async answer(trialIndex: number, data: TrialData): Promise<{ reply: Promise<AnswerReply> }> {
    if (this.closed) {
      return { reply: new Promise(() => {}) };
    }
    const id = answerId(this.credentials.session, trialIndex);
    const { answer, reaction_time_s, onset_requested_s, onset_measured_s } = data;
    const { frame_interval_s, dropped_frames, input } = data;
    const body = {
      id,
      trial_index: trialIndex,
      answer,
      reaction_time_s,
      onset_requested_s,
      onset_measured_s,
      frame_interval_s,
      dropped_frames,
      input,
    };
    const { reply } = await this.outbox.add(this.post(id, "answers", body));
    return { reply: reply as Promise<AnswerReply> };
  }

  /** Keep and send something that happened besides answers; failing to is no one's trouble. */
  event(kind: string, detail: Detail = {}): void {
    if (this.closed) {
      return;
    }
    const at_s = performance.now() / 1000;
    const id = `${this.credentials.session}.event.${performance.timeOrigin}.${this.eventCount++}`;
    void this.outbox.add(this.post(id, "events", { kind, detail: { at_s, ...detail } }));
  }

  /** Take nothing more: the participant has withdrawn. */
  close(): void {
    this.closed = true;
    this.notice.show(null);
  }

  /** The trials of this session whose answers are kept here but not acknowledged yet. */
  unsentTrials(): number[] {
    return this.outbox
      .unsent()
      .filter((post) => post.token === this.credentials.token)
      .map(trialIndexOf)
      .filter((index) => index !== undefined);
  }

  /** Resolve when the server has acknowledged, or refused, everything. */
  allSent(): Promise<void> {
    return this.outbox.empty();
  }

  /** Record what happens to the window and the connection until `signal` aborts. */
  watchWindow(signal: AbortSignal): void {
    const watch = (name: string, kind: string, detail: () => Detail = () => ({})) =>
      window.addEventListener(name, () => this.event(kind, detail()), { signal });
    watch("blur", "blur");
    watch("focus", "focus");
    watch("offline", "offline");
    watch("online", "online");
    watch("fullscreenchange", "fullscreen", () => ({ on: document.fullscreenElement !== null }));
    window.addEventListener(
      "resize",
      settled(() => this.event("resize", describeWindow())),
      {
        signal,
      },
    );
  }

  private post(id: string, kind: "answers" | "events", body: unknown): Post {
    const path = `${sessionPath(this.credentials.session)}/${kind}`;
    return { id, path, token: this.credentials.token, body };
  }

  private refused(post: Post, error: unknown): void {
    if (!this.closed && post.token === this.credentials.token && trialIndexOf(post) !== undefined) {
      const status = error instanceof ApiError ? error.status : 0;
      this.notice.show("notice.rejected");
      this.event("answer-refused", { id: post.id, status });
    }
  }

  /** The browser refuses to keep data, as in some private windows: a reload would lose answers. */
  private notKept(): void {
    if (!this.toldNotKept) {
      this.toldNotKept = true;
      this.event("not-kept");
    }
  }
}

function trialIndexOf(post: Post): number | undefined {
  return (post.body as { trial_index?: number }).trial_index;
}

/** Call `action` once a burst of calls has been quiet for a moment, as while a window is drawn. */
function settled(action: () => void): () => void {
  const quiet_ms = 300;
  let timer = 0;
  return () => {
    window.clearTimeout(timer);
    timer = window.setTimeout(action, quiet_ms);
  };
}
