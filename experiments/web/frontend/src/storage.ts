/** Where posts lie until the server has acknowledged them. */

import { type DBSchema, type IDBPDatabase, openDB } from "idb";

/** One post to the server, with all that sending it again after a reload needs. */
export interface Post {
  id: string;
  path: string;
  token: string;
  body: unknown;
}

/** Keeps posts in the order of their adding; an id that is there already is replaced. */
export interface PostStore {
  /** Whether the posts outlive the page. */
  readonly persistent: boolean;
  all(): Promise<Post[]>;
  put(post: Post): Promise<void>;
  remove(post: Post): Promise<void>;
}

const DATABASE = "trompe";
const STORE = "posts";

interface Schema extends DBSchema {
  // The token keeps apart two sessions of one name, as when the server's data were removed.
  posts: { key: [token: string, id: string]; value: Post & { added: number } };
}

/** Open the browser's database, or keep posts in memory where it is refused. */
export async function openPostStore(): Promise<PostStore> {
  try {
    const database = await openDB<Schema>(DATABASE, 1, {
      upgrade: (opened) => {
        opened.createObjectStore(STORE, { keyPath: ["token", "id"] });
      },
    });
    return new DatabasePostStore(database);
  } catch {
    return new MemoryPostStore();
  }
}

class DatabasePostStore implements PostStore {
  readonly persistent = true;

  constructor(private readonly database: IDBPDatabase<Schema>) {}

  async all(): Promise<Post[]> {
    const rows = await this.database.getAll(STORE);
    rows.sort((a, b) => a.added - b.added);
    return rows.map(({ added: _, ...post }) => post);
  }

  async put(post: Post): Promise<void> {
    // Strict: resolved only when the answer is on the disk, not in a buffer of the system.
    const transaction = this.database.transaction(STORE, "readwrite", { durability: "strict" });
    await transaction.store.put({ ...post, added: performance.timeOrigin + performance.now() });
    await transaction.done;
  }

  async remove(post: Post): Promise<void> {
    await this.database.delete(STORE, [post.token, post.id]);
  }
}

/** Keeps posts for as long as the page is open. */
export class MemoryPostStore implements PostStore {
  readonly persistent = false;
  private readonly posts = new Map<string, Post>();

  async all(): Promise<Post[]> {
    return [...this.posts.values()];
  }

  async put(post: Post): Promise<void> {
    this.posts.set(`${post.token} ${post.id}`, post);
  }

  async remove(post: Post): Promise<void> {
    this.posts.delete(`${post.token} ${post.id}`);
  }
}
