// What the worker says about its connection: each begins a sentence, which the page completes.

export const worker_texts = {
  lost: (host: string) => `the connection to ${host} was lost`,
  unreachable: (host: string) => `the server at ${host} cannot be reached`,
  silent: (host: string, seconds: number) => `the server at ${host} has sent nothing for ${seconds} s`,
  no_connection: "there is no connection",
  snapshots_refused: "The server refuses to send snapshots",
};
