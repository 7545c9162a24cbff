"use strict";
// What becomes of the session, for all pages of a browser together: it opens six connections to a server at most, and every page
// that listened by itself would keep one for good.

const pages = new Set();
let latest = null;  // { text, away }

function tell(news) {
  latest = { ...latest, ...news };
  for (const page of pages) page.postMessage(latest);
}

function listen() {
  const events = new EventSource("events");
  events.onmessage = event => tell({ text: event.data, away: false });
  events.onerror = () => {
    tell({ away: true });
    // A browser gives up on a server that refuses; a server that starts again is found.
    if (events.readyState === EventSource.CLOSED) setTimeout(listen, 1000);
  };
}

onconnect = event => {
  const [page] = event.ports;
  page.onmessage = ({ data }) => {
    if (data === "leave") { pages.delete(page); return; }
    pages.add(page);
    // A page that comes late sees what the others see.
    if (latest) page.postMessage(latest);
  };
};

listen();
