/** The queue of posts: each is kept first, then sent on its own until the server acknowledges it. */

import { ApiError, retry } from "./retry";
import type { Post, PostStore } from "./storage";

/** What became of a post that was added. */
export interface Delivery {
  /** The server's reply; rejects with an `ApiError` if the server refuses the post for good. */
  reply: Promise<unknown>;
}

/** What an outbox tells of its work. */
export interface OutboxListener {
  /** Sending began to fail for the moment (`true`), or works again (`false`). */
  onWaiting?(waiting: boolean): void;
  /** The server refused a post for good; it has left the queue. */
  onRefused?(post: Post, error: unknown): void;
  /** A post could not be kept, so it would not survive a reload; it is sent all the same. */
  onNotKept?(post: Post): void;
}

interface Entry {
  post: Post;
  resolve(reply: unknown): void;
  reject(error: unknown): void;
}

/**
 * Tell whether the server does not know the post's session: another server that used this address
 * before may, so the post stays in the store and is tried again with the next page.
 */
function isUnknownHere(error: unknown): boolean {
  return error instanceof ApiError && (error.status === 401 || error.status === 404);
}

/**
 * Sends posts one after another, oldest first.
 *
 * A post leaves the store only when its server has acknowledged or refused it. A post that the
 * server already has must be harmless to send again: the page may be closed between the server's
 * acknowledgement and the removal here.
 */
export class Outbox {
  private readonly queue: Entry[] = [];
  private sending = false;
  private waiting = false;
  private whenEmpty: (() => void)[] = [];

  constructor(
    private readonly store: PostStore,
    private readonly send: (post: Post) => Promise<unknown>,
    private readonly listener: OutboxListener = {},
  ) {}

  /** Take up what an earlier page left unsent. */
  async resume(): Promise<void> {
    for (const post of await this.store.all()) {
      this.enqueue(post).reply.catch(() => {});
    }
  }

  /** Keep a post, then send it; resolves as soon as it is kept. */
  async add(post: Post): Promise<Delivery> {
    try {
      await this.store.put(post);
    } catch {
      this.listener.onNotKept?.(post);
    }
    const delivery = this.enqueue(post);
    delivery.reply.catch(() => {}); // a caller may not care: `onRefused` hears of it
    return delivery;
  }

  /** The posts that are not acknowledged yet, oldest first. */
  unsent(): Post[] {
    return this.queue.map((entry) => entry.post);
  }

  /** Resolve when everything has been acknowledged or refused. */
  async empty(): Promise<void> {
    if (this.queue.length > 0) {
      await new Promise<void>((resolve) => this.whenEmpty.push(resolve));
    }
  }

  private enqueue(post: Post): Delivery {
    const reply = new Promise<unknown>((resolve, reject) => {
      this.queue.push({ post, resolve, reject });
    });
    void this.sendAll();
    return { reply };
  }

  private async sendAll(): Promise<void> {
    if (this.sending) {
      return;
    }
    this.sending = true;
    for (let entry = this.queue[0]; entry !== undefined; entry = this.queue[0]) {
      await this.sendOne(entry);
      this.queue.shift();
    }
    this.sending = false;
    for (const resolve of this.whenEmpty.splice(0)) {
      resolve();
    }
  }

  private async sendOne({ post, resolve, reject }: Entry): Promise<void> {
    try {
      const reply = await retry(
        () => this.send(post),
        () => this.setWaiting(true),
      );
      await this.forget(post);
      this.setWaiting(false);
      resolve(reply);
    } catch (error) {
      if (!isUnknownHere(error)) {
        await this.forget(post);
      }
      this.setWaiting(false);
      this.listener.onRefused?.(post, error);
      reject(error);
    }
  }

  private async forget(post: Post): Promise<void> {
    // Failing only means that the post is sent once more after a reload.
    await this.store.remove(post).catch(() => {});
  }

  private setWaiting(waiting: boolean): void {
    if (waiting !== this.waiting) {
      this.waiting = waiting;
      this.listener.onWaiting?.(waiting);
    }
  }
}
