import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Outbox, type OutboxListener } from "../src/outbox";
import { ApiError } from "../src/retry";
import { MemoryPostStore, openPostStore, type Post, type PostStore } from "../src/storage";

let number = 0;

/** A post of a session of its own, so that tests do not see each other's. */
function newPost(trial: number, token = `token-${number}`): Post {
  return { id: `study.P0001.1.000${trial}`, path: "/answers", token, body: { trial_index: trial } };
}

/** A server that counts what it stored, and fails or refuses as the test wants. */
class Server {
  readonly stored = new Map<string, number>();
  failures: unknown[] = [];

  async send(post: Post): Promise<string> {
    const failure = this.failures.shift();
    if (failure !== undefined) {
      throw failure;
    }
    this.stored.set(post.id, (this.stored.get(post.id) ?? 0) + 1);
    return "acknowledged";
  }

  outbox(store: PostStore, listener: OutboxListener = {}): Outbox {
    return new Outbox(store, (post) => this.send(post), listener);
  }
}

const disconnected = () => new TypeError("Failed to fetch");

beforeEach(() => {
  number += 1;
  vi.useFakeTimers({ toFake: ["setTimeout", "clearTimeout"] });
});

afterEach(async () => {
  vi.useRealTimers();
  const store = await openPostStore();
  await Promise.all((await store.all()).map((post) => store.remove(post)));
});

describe("an outbox over the browser's database", () => {
  it("forgets a post only when the server has acknowledged it", async () => {
    const store = await openPostStore();
    const server = new Server();
    server.failures = [disconnected()];
    const outbox = server.outbox(store);
    const { reply } = await outbox.add(newPost(0));
    expect(await store.all()).toEqual([newPost(0)]);
    await vi.advanceTimersByTimeAsync(60_000);
    expect(await reply).toBe("acknowledged");
    expect(await store.all()).toEqual([]);
  });

  it("tries again until the connection is back, and tells of it once each way", async () => {
    const waits: boolean[] = [];
    const server = new Server();
    server.failures = [disconnected(), new ApiError(503, "busy", ""), disconnected()];
    const outbox = server.outbox(await openPostStore(), { onWaiting: (now) => waits.push(now) });
    await outbox.add(newPost(0));
    await outbox.add(newPost(1));
    await vi.advanceTimersByTimeAsync(60_000);
    await outbox.empty();
    expect([...server.stored.values()]).toEqual([1, 1]);
    expect(waits).toEqual([true, false]);
  });

  it("tries at once when the browser reports a connection", async () => {
    const server = new Server();
    server.failures = [disconnected()];
    const outbox = server.outbox(await openPostStore());
    await outbox.add(newPost(0));
    await vi.advanceTimersByTimeAsync(0);
    expect(server.stored.size).toBe(0);
    window.dispatchEvent(new Event("online"));
    await outbox.empty();
    expect(server.stored.size).toBe(1);
  });

  it("sends after a reload what the page before could not", async () => {
    const before = new Server();
    before.failures = Array.from({ length: 100 }, disconnected);
    const closed = before.outbox(await openPostStore());
    await closed.add(newPost(0));
    await closed.add(newPost(1));

    const after = new Server();
    const outbox = after.outbox(await openPostStore());
    await outbox.resume();
    expect(outbox.unsent().map((post) => post.id)).toEqual([newPost(0).id, newPost(1).id]);
    await outbox.empty();
    expect([...after.stored.keys()]).toEqual([newPost(0).id, newPost(1).id]);
  });

  it("keeps one entry for a post that is added twice", async () => {
    const store = await openPostStore();
    const server = new Server();
    server.failures = Array.from({ length: 100 }, disconnected);
    const outbox = server.outbox(store);
    await outbox.add(newPost(0));
    await outbox.add(newPost(0));
    expect(await store.all()).toHaveLength(1);
  });

  it("keeps apart two sessions of one name", async () => {
    const store = await openPostStore();
    await store.put(newPost(0, "old"));
    await store.put(newPost(0, "new"));
    await store.remove(newPost(0, "old"));
    expect(await store.all()).toEqual([newPost(0, "new")]);
  });

  it.each([
    [409, []],
    [422, []],
    [413, []],
    // The session is another server's, which may come back to this address.
    [401, [newPost(0).id]],
    [404, [newPost(0).id]],
  ])("goes on past a post refused with %i, which leaves %o", async (status, left) => {
    const refused: string[] = [];
    const store = await openPostStore();
    const server = new Server();
    server.failures = [new ApiError(status, "refused", "no")];
    const outbox = server.outbox(store, { onRefused: (post) => refused.push(post.id) });
    const first = await outbox.add(newPost(0));
    const second = await outbox.add(newPost(1));
    await expect(first.reply).rejects.toMatchObject({ status });
    expect(await second.reply).toBe("acknowledged");
    expect(refused).toEqual([newPost(0).id]);
    expect((await store.all()).map((post) => post.id)).toEqual(left);
  });
});

describe("without the browser's database", () => {
  it("posts are kept in memory, and the store says that they will not last", async () => {
    const open = vi.spyOn(indexedDB, "open").mockImplementation(() => {
      throw new DOMException("refused", "SecurityError");
    });
    const store = await openPostStore();
    open.mockRestore();
    expect(store.persistent).toBe(false);
    const server = new Server();
    const outbox = server.outbox(store);
    await outbox.add(newPost(0));
    await outbox.empty();
    expect(server.stored.size).toBe(1);
    expect(await store.all()).toEqual([]);
  });

  it("a post that cannot be kept is sent all the same, and told of", async () => {
    const notKept: string[] = [];
    const store = new MemoryPostStore();
    vi.spyOn(store, "put").mockRejectedValue(new DOMException("full", "QuotaExceededError"));
    const server = new Server();
    const outbox = server.outbox(store, { onNotKept: (post) => notKept.push(post.id) });
    await outbox.add(newPost(0));
    await outbox.empty();
    expect(server.stored.size).toBe(1);
    expect(notKept).toEqual([newPost(0).id]);
  });
});
