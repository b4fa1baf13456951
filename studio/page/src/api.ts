/** Requests to the server; a refusal becomes an Error with the server's own sentence. */

async function answered(response: Response): Promise<Response> {
  if (response.ok) return response;
  const said = await response.json().catch(() => null);
  throw new Error(said?.error ?? `the server answered ${response.status}`);
}

async function sent(path: string, method: string, body?: unknown): Promise<Response> {
  const request: RequestInit = { method };
  if (body !== undefined) request.body = JSON.stringify(body);
  let response: Response;
  try {
    response = await fetch(path, request);
  } catch {
    throw new Error("the server does not answer: is `bekker studio` still running?");
  }
  return answered(response);
}

export async function get<T>(path: string): Promise<T> {
  return (await sent(path, "GET")).json();
}

export async function post<T>(path: string, body: unknown = {}): Promise<T> {
  return (await sent(path, "POST", body)).json();
}

export async function remove(path: string): Promise<void> {
  await sent(path, "DELETE");
}

/** Sends a file as it is; its text is checked by the server. */
export async function put(path: string, file: Blob): Promise<void> {
  await answered(await fetch(path, { method: "PUT", body: file }));
}

/** Asks for a file and gives it to the browser to be saved. */
export async function save(path: string, body: unknown, name: string): Promise<void> {
  give(await (await sent(path, "POST", body)).blob(), name);
}

/** Gives a file to the browser to be saved. */
export function give(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
