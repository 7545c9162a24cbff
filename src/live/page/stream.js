"use strict";
// The event stream of the session, shared by all pages of a browser: a browser opens at most six connections to a server, and every
// page with its own stream would occupy one.

const pages = new Set();
let latest = null;  // { text, away }

function broadcast(message) {
  latest = { ...latest, ...message };
  for (const page of pages) page.postMessage(latest);
}

function listen() {
  const events = new EventSource("events");
  events.onmessage = event => broadcast({ text: event.data, away: false });
  events.onerror = () => {
    broadcast({ away: true });
    // A browser stops reconnecting when the server refuses; this finds a restarted server.
    if (events.readyState === EventSource.CLOSED) setTimeout(listen, 1000);
  };
}

onconnect = event => {
  const [page] = event.ports;
  page.onmessage = ({ data }) => {
    if (data === "leave") { pages.delete(page); return; }
    pages.add(page);
    // A page opened later gets the last event.
    if (latest) page.postMessage(latest);
  };
};

listen();
