//! HTTP server that shows a session to browsers on the same machine.
//!
//! | request | response |
//! | `GET /` | the page; its style sheet and scripts under their names |
//! | `GET /state` | the [`State`](super::State), as JSON |
//! | `GET /events` | the state after each change, as server-sent events |
//! | `GET /picture/1795/7` | picture 7 of session 1795, as PNG |
//! | `GET /tiles/1795/7` | the number of rays and the error of each tile of that picture, a [`PictureTiles`], as JSON |
//! | `GET /frame/1795/2/240` | the finished picture of frame 240 of generation 2 of session 1795, as PNG, if it is kept |
//! | `POST /view` | changes the view according to a [`ViewChange`], as JSON |
//! | `POST /edit` | changes values of the scene according to a [`SceneEdit`], as JSON; 409 and the reason if that is not possible |
//! | `POST /outline` | the rows of the list of the scene's parts for an [`OutlineRequest`](super::OutlineRequest), as JSON |
//! | `POST /part` | the values of a part of the scene, such as `{"entity": "ball"}`, or for null the controls of an engine: a [`PartInfo`](super::PartInfo) or null, as JSON |
//! | `POST /tracks` | the keys of tracks, and the shots, as JSON |
//! | `POST /path` | the path of the camera of the current frame for a [`PathRequest`](super::PathRequest): a [`PathInfo`](super::PathInfo) or null, as JSON |
//! | `POST /camera` | the camera of the current frame, as JSON; 409 and the reason if it cannot be moved |
//! | `POST /export` | renders frames into files according to a [`ExportRequest`](super::ExportRequest), or cancels that for null, as JSON; 409 and the reason if that is not possible |
//! | `GET /movie/1795` | the movie that session 1795 has made last |
//! | `POST /open` | opens the editor at a place such as `"ball.ron:12"`, as JSON; 409 and the reason if that is not possible |
//! | `POST /probe` | the description of pixel `[column, row]`: a [`PixelInfo`](super::PixelInfo) or null, as JSON |
//! | `POST /rays` | the rays of `[[column, row], sample]`: a [`RayTreeInfo`](super::RayTreeInfo) or null, as JSON |
//!
//! A page of another origin can make a browser send requests to this server. It can hide neither its origin (`Origin`, `Sec-Fetch-Site`)
//! nor, if its name resolves to this machine, that name (`Host`). Such requests are rejected; programs on the same machine are admitted.

use std::convert::Infallible;
use std::fs;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::pin::pin;
use std::str::FromStr;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Path, Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, HeaderName, HeaderValue, ORIGIN,
};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::{self, Next};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use futures_util::future::select;
use futures_util::stream::{self, Stream, StreamExt};
use hyper_util::rt::{TokioExecutor, TokioIo, TokioTimer};
use hyper_util::server::conn::auto;
use hyper_util::service::TowerToHyperService;
use tokio::runtime::Builder;
use tokio::sync::oneshot;
use tokio::task::spawn_blocking;
use tokio::time::timeout;

use super::camera_view::CameraView;
use super::commands::{Reply, SceneEdit, SessionCommand, ViewChange};
use super::export::{ExportEnd, ExportRequest, ExportState};
use super::outline::OutlineRequest;
use super::path_info::PathRequest;
use super::session::Handle;
use super::tile_stats::PictureTiles;
use crate::scene::ScenePart;

/// Path, media type and content of each file of the page.
const FILES: &[(&str, &str, &str)] = &[
    ("/", "text/html; charset=utf-8", include_str!("page/page.html")),
    ("/page.css", "text/css; charset=utf-8", include_str!("page/page.css")),
    ("/page.js", SCRIPT, include_str!("page/page.js")),
    ("/timeline.js", SCRIPT, include_str!("page/timeline.js")),
    ("/export.js", SCRIPT, include_str!("page/export.js")),
    ("/passes.js", SCRIPT, include_str!("page/passes.js")),
    ("/lanes.js", SCRIPT, include_str!("page/lanes.js")),
    ("/frames.js", SCRIPT, include_str!("page/frames.js")),
    ("/picture.js", SCRIPT, include_str!("page/picture.js")),
    ("/outline.js", SCRIPT, include_str!("page/outline.js")),
    ("/panels.js", SCRIPT, include_str!("page/panels.js")),
    ("/mistakes.js", SCRIPT, include_str!("page/mistakes.js")),
    ("/rays.js", SCRIPT, include_str!("page/rays.js")),
    ("/magnify.js", SCRIPT, include_str!("page/magnify.js")),
    ("/path.js", SCRIPT, include_str!("page/path.js")),
    ("/ruler.js", SCRIPT, include_str!("page/ruler.js")),
    ("/pixels.js", SCRIPT, include_str!("page/pixels.js")),
    ("/heat.js", SCRIPT, include_str!("page/heat.js")),
    ("/curve.js", SCRIPT, include_str!("page/curve.js")),
    ("/edit.js", SCRIPT, include_str!("page/edit.js")),
    ("/camera.js", SCRIPT, include_str!("page/camera.js")),
    ("/fly.js", SCRIPT, include_str!("page/fly.js")),
    ("/move.js", SCRIPT, include_str!("page/move.js")),
    ("/gizmo.js", SCRIPT, include_str!("page/gizmo.js")),
    ("/values.js", SCRIPT, include_str!("page/values.js")),
    ("/input.js", SCRIPT, include_str!("page/input.js")),
    ("/stream.js", SCRIPT, include_str!("page/stream.js")),
];

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Content security policy of the page, which permits requests to this server only.
const POLICY: &str = "default-src 'none'; img-src 'self' data: blob:; connect-src 'self'; style-src 'self'; script-src 'self'; \
                      worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// Time within which a request must arrive completely. Slower requests are dropped, so that they do not hold connections. Requests of this
/// machine arrive within milliseconds, even when it is busy rendering.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(5);
/// Maximum size of a request's body in bytes. Valid ones have some hundred.
const LARGEST_BODY: usize = 1 << 12;
/// Delay before accepting connections again after a failure, when there is no room for another connection. Without it, the thread would
/// be busy until there is room.
const ACCEPT_RETRY_DELAY: Duration = Duration::from_millis(100);
/// Interval between keep-alive comments on idle event streams, short enough for proxies, which drop connections after half a minute or more.
const KEEP_ALIVE: Duration = Duration::from_secs(10);

/// A server at the loopback address 127.0.0.1, which runs on a separate thread until it is dropped.
#[derive(Debug)]
pub struct Server {
    port: u16,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Clone)]
struct ServerState {
    session: Handle,
    guard: Arc<Guard>,
}

impl Server {
    /// Serves a session at a port, or at any free port if `port` is 0.
    ///
    /// # Errors
    ///
    /// If the port is taken, or may not be used.
    pub fn start(port: u16, session: Handle) -> io::Result<Self> {
        Self::start_for(&[], port, session)
    }

    /// Serves a session like [`start`](Self::start), and also accepts requests addressed to one of `hosts`.
    ///
    /// # Errors
    ///
    /// As [`start`](Self::start).
    pub fn start_for(hosts: &[HostName], port: u16, session: Handle) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let port = listener.local_addr()?.port();
        let runtime = Builder::new_current_thread().enable_io().enable_time().build()?;
        let (stop, stopped) = oneshot::channel();
        let router = router(ServerState { session, guard: Arc::new(Guard::new(port, hosts)) });
        let thread = thread::spawn(move || {
            runtime.block_on(async {
                let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
                // Open pages keep their connections open, so these are not awaited.
                select(pin!(serve(&listener, &router)), stopped).await;
            });
        });
        Ok(Self { port, stop: Some(stop), thread: Some(thread) })
    }

    /// Returns the address of the server.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        (Ipv4Addr::LOCALHOST, self.port).into()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(stop) = self.stop.take() {
            let _ = stop.send(());
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Accepts and serves connections. A client that begins a request and does not complete it is dropped.
async fn serve(listener: &tokio::net::TcpListener, router: &Router) {
    let mut connections = auto::Builder::new(TokioExecutor::new()).http1_only();
    connections.http1().timer(TokioTimer::new()).header_read_timeout(REQUEST_TIMEOUT);
    let connections = Arc::new(connections);
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(ACCEPT_RETRY_DELAY).await;
            continue;
        };
        // Events are short and urgent.
        let _ = stream.set_nodelay(true);
        let (connections, service) = (Arc::clone(&connections), TowerToHyperService::new(router.clone()));
        tokio::spawn(async move {
            // Errors of a connection concern only its client.
            let _ = connections.serve_connection(TokioIo::new(stream), service).await;
        });
    }
}

fn router(shared: ServerState) -> Router {
    let files = FILES.iter().fold(Router::new(), |router, &(path, kind, text)| {
        router.route(path, get(move || async move { ([(CONTENT_TYPE, kind)], text) }))
    });
    files
        .route("/state", get(state))
        .route("/events", get(events))
        .route("/picture/{session}/{id}", get(picture))
        .route("/tiles/{session}/{id}", get(tiles))
        .route("/frame/{session}/{generation}/{frame}", get(frame))
        .route("/view", post(view))
        .route("/probe", post(probe))
        .route("/rays", post(rays))
        .route("/edit", post(edit))
        .route("/outline", post(outline))
        .route("/part", post(part))
        .route("/tracks", post(tracks))
        .route("/export", post(export))
        .route("/movie/{session}", get(movie))
        .route("/camera", post(camera))
        .route("/placement", post(placement))
        .route("/path", post(path))
        .route("/open", post(open))
        .layer(middleware::from_fn_with_state(shared.clone(), guarded))
        .with_state(shared)
}

/// Rejects requests of other origins, and sets strict headers on every response.
async fn guarded(
    State(shared): State<ServerState>,
    headers: HeaderMap,
    request: Request,
    next: Next,
) -> Response {
    let mut response = if shared.guard.admits(&headers) {
        match complete(request).await {
            Some(request) => next.run(request).await,
            None => (StatusCode::REQUEST_TIMEOUT, "the request is too slow or too large\n").into_response(),
        }
    } else {
        let why = "this page is for this machine's own browser; under another name or port than its own, as behind \
                   `ssh -L`, `rayreel watch --allow-host NAME:PORT` allows it\n";
        (StatusCode::FORBIDDEN, why).into_response()
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (CONTENT_SECURITY_POLICY, POLICY),
        (HeaderName::from_static("x-content-type-options"), "nosniff"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (HeaderName::from_static("referrer-policy"), "no-referrer"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    headers.entry(CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    response
}

/// Returns a request with its complete body, or `None` if it is too slow or too large.
async fn complete(request: Request) -> Option<Request> {
    let (head, body) = request.into_parts();
    let bytes = timeout(REQUEST_TIMEOUT, read(body)).await.ok()??;
    Some(Request::from_parts(head, bytes.into()))
}

/// Reads a body to its end. Returns `None` if it is too large. Excess bytes are read and discarded, since a client that is disconnected
/// while still sending might not receive the response.
async fn read(body: Body) -> Option<Vec<u8>> {
    let mut pieces = body.into_data_stream();
    let mut all = Some(Vec::new());
    while let Some(piece) = pieces.next().await {
        let piece = piece.ok()?;
        all = all.filter(|read| read.len() + piece.len() <= LARGEST_BODY);
        if let Some(read) = &mut all {
            read.extend_from_slice(&piece);
        }
    }
    all
}

async fn state(State(shared): State<ServerState>) -> Response {
    json(&shared.session.state())
}

async fn events(State(shared): State<ServerState>) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let mut states = shared.session.subscribe();
    // The first event is the current state.
    states.mark_changed();
    let stream = stream::unfold(states, |mut states| async {
        states.changed().await.ok()?;
        let text = serde_json::to_string(&*states.borrow_and_update()).ok()?;
        Some((Ok(Event::default().data(text)), states))
    });
    Sse::new(stream).keep_alive(KeepAlive::new().interval(KEEP_ALIVE))
}

async fn picture(State(shared): State<ServerState>, Path((session, id)): Path<(u64, u64)>) -> Response {
    png(&shared, session, shared.session.picture(id).map(|picture| picture.png))
}

async fn tiles(State(shared): State<ServerState>, Path((session, id)): Path<(u64, u64)>) -> Response {
    let picture = shared.session.picture(id).filter(|_| shared.session.state().session == session);
    match picture.as_ref().and_then(PictureTiles::of) {
        Some(tiles) => json(&tiles),
        None => (StatusCode::NOT_FOUND, "this picture is coarse or out of date\n").into_response(),
    }
}

async fn frame(
    State(shared): State<ServerState>,
    Path((session, generation, frame)): Path<(u64, u64, u32)>,
) -> Response {
    png(&shared, session, shared.session.frame(generation, frame))
}

/// Responds with a picture of a session. A browser may hold picture numbers of another session, which can coincide with the numbers of this
/// one.
fn png(shared: &ServerState, session: u64, picture: Option<Arc<[u8]>>) -> Response {
    match picture.filter(|_| shared.session.state().session == session) {
        Some(png) => {
            let png = Bytes::from_owner(png);
            ([(CONTENT_TYPE, "image/png"), (CACHE_CONTROL, "private, max-age=60")], png).into_response()
        }
        None => (StatusCode::NOT_FOUND, "this picture is out of date\n").into_response(),
    }
}

async fn view(State(shared): State<ServerState>, body: Bytes) -> Response {
    match serde_json::from_slice::<ViewChange>(&body) {
        Ok(view) => {
            shared.session.send(SessionCommand::ViewChange(view));
            StatusCode::NO_CONTENT.into_response()
        }
        Err(error) => refused(&error),
    }
}

async fn probe(State(shared): State<ServerState>, body: Bytes) -> Response {
    let pixel = match serde_json::from_slice::<(u32, u32)>(&body) {
        Ok(pixel) => pixel,
        Err(error) => return refused(&error),
    };
    answer(&shared, |reply| SessionCommand::Probe(pixel, reply), |info| json(&info)).await
}

async fn rays(State(shared): State<ServerState>, body: Bytes) -> Response {
    match serde_json::from_slice::<((u32, u32), u32)>(&body) {
        Ok((pixel, sample)) => {
            answer(&shared, |reply| SessionCommand::Rays(pixel, sample, reply), |info| json(&info)).await
        }
        Err(error) => refused(&error),
    }
}

async fn edit(State(shared): State<ServerState>, body: Bytes) -> Response {
    match serde_json::from_slice::<SceneEdit>(&body) {
        Ok(edit) => answer(&shared, |reply| SessionCommand::Edit(edit, reply), done).await,
        Err(error) => refused(&error),
    }
}

async fn export(State(shared): State<ServerState>, body: Bytes) -> Response {
    match serde_json::from_slice::<Option<ExportRequest>>(&body) {
        Ok(Some(request)) => answer(&shared, |reply| SessionCommand::Export(request, reply), done).await,
        Ok(None) => {
            let session = shared.session.clone();
            let _ = spawn_blocking(move || session.cancel_export()).await;
            StatusCode::NO_CONTENT.into_response()
        }
        Err(error) => refused(&error),
    }
}

async fn movie(State(shared): State<ServerState>, Path(session): Path<u64>) -> Response {
    let state = shared.session.state();
    let is_made = |export: &ExportState| export.is_movie && export.end == Some(ExportEnd::Complete);
    let export = state.export.filter(|export| is_made(export) && state.session == session);
    let Some(ExportState { target, .. }) = export else {
        return (StatusCode::NOT_FOUND, "no movie was made\n").into_response();
    };
    match spawn_blocking(move || fs::read(target)).await {
        Ok(Ok(bytes)) => ([(CONTENT_TYPE, "application/octet-stream")], bytes).into_response(),
        _ => (StatusCode::NOT_FOUND, "the movie cannot be read\n").into_response(),
    }
}

async fn open(State(shared): State<ServerState>, body: Bytes) -> Response {
    match serde_json::from_slice::<String>(&body) {
        Ok(place) => answer(&shared, |reply| SessionCommand::Open(place, reply), done).await,
        Err(error) => refused(&error),
    }
}

/// Responds with the reason why something could not be done, if there is one.
fn done(result: Result<(), String>) -> Response {
    match result {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(why) => (StatusCode::CONFLICT, why).into_response(),
    }
}

async fn outline(State(shared): State<ServerState>, body: Bytes) -> Response {
    match serde_json::from_slice::<OutlineRequest>(&body) {
        Ok(request) => {
            answer(&shared, |reply| SessionCommand::Outline(request, reply), |rows| json(&rows)).await
        }
        Err(error) => refused(&error),
    }
}

async fn part(State(shared): State<ServerState>, body: Bytes) -> Response {
    match serde_json::from_slice::<Option<ScenePart>>(&body) {
        Ok(part) => answer(&shared, |reply| SessionCommand::Part(part, reply), |info| json(&info)).await,
        Err(error) => refused(&error),
    }
}

async fn placement(State(shared): State<ServerState>, body: Bytes) -> Response {
    match serde_json::from_slice::<ScenePart>(&body) {
        Ok(part) => answer(&shared, |reply| SessionCommand::Placement(part, reply), |info| json(&info)).await,
        Err(error) => refused(&error),
    }
}

async fn tracks(State(shared): State<ServerState>) -> Response {
    answer(&shared, SessionCommand::Tracks, |tracks| json(&tracks)).await
}

async fn path(State(shared): State<ServerState>, body: Bytes) -> Response {
    match serde_json::from_slice::<PathRequest>(&body) {
        Ok(request) => {
            answer(&shared, |reply| SessionCommand::Path(request, reply), |path| json(&path)).await
        }
        Err(error) => refused(&error),
    }
}

async fn camera(State(shared): State<ServerState>) -> Response {
    let respond = |camera: Result<CameraView, String>| {
        camera.map_or_else(|why| (StatusCode::CONFLICT, why).into_response(), |camera| json(&camera))
    };
    answer(&shared, SessionCommand::Camera, respond).await
}

/// Sends a command to the session, and responds with its result.
async fn answer<T: Send + 'static>(
    shared: &ServerState,
    command: impl FnOnce(Reply<T>) -> SessionCommand,
    respond: impl FnOnce(T) -> Response,
) -> Response {
    let (sender, reply) = oneshot::channel();
    let send = move |result| {
        let _ = sender.send(result);
    };
    shared.session.send(command(Reply(Box::new(send))));
    reply.await.map_or_else(|_| StatusCode::SERVICE_UNAVAILABLE.into_response(), respond)
}

fn json(value: &impl serde::Serialize) -> Response {
    match serde_json::to_string(value) {
        Ok(text) => ([(CONTENT_TYPE, "application/json")], text).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

fn refused(error: &serde_json::Error) -> Response {
    (StatusCode::BAD_REQUEST, format!("{error}\n")).into_response()
}

/// An additional name under which the server may be addressed, for a port of another machine, or another port of this one, that is
/// forwarded to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostName {
    /// The name in lower case.
    name: String,
    /// The port; `None` for any port.
    port: Option<u16>,
}

/// The error for a string that is not a host name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "write a name as a browser's address line has it, with or without a port, as in `localhost:9000` or `workstation`"
)]
pub struct NoHostName;

impl FromStr for HostName {
    type Err = NoHostName;

    fn from_str(text: &str) -> Result<Self, NoHostName> {
        let is_plain = |name: &str| {
            name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-._".contains(&byte))
                || name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).is_some_and(|name| {
                    name.bytes().all(|byte| byte.is_ascii_hexdigit() || b":.".contains(&byte))
                })
        };
        let (name, port) = split(text).ok_or(NoHostName)?;
        if name.is_empty() || !is_plain(name) {
            return Err(NoHostName);
        }
        Ok(Self { name: name.to_ascii_lowercase(), port })
    }
}

/// Splits a host into name and port. Returns `None` if the port is invalid.
fn split(host: &str) -> Option<(&str, Option<u16>)> {
    match host.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') => Some((name, Some(port.parse().ok()?))),
        _ => Some((host, None)),
    }
}

/// The filter that rejects requests of other origins.
#[derive(Clone, Debug)]
struct Guard(Vec<HostName>);

impl Guard {
    /// Creates the guard of the server at `port`, which may also be addressed by `hosts`.
    fn new(port: u16, hosts: &[HostName]) -> Self {
        let own = |name: &str, port| HostName { name: name.to_owned(), port };
        let mut all = hosts.to_vec();
        all.extend(["127.0.0.1", "localhost"].map(|name| own(name, Some(port))));
        Self(all)
    }

    /// Returns whether a request comes from the server's own pages, or from no page at all.
    fn admits(&self, headers: &HeaderMap) -> bool {
        let values = |name| headers.get_all(name).iter().map(|value| value.to_str().unwrap_or_default());
        let mut hosts = values(HOST.as_str());
        let (Some(host), None) = (hosts.next(), hosts.next()) else { return false };
        // A page sends its requests to the host that served it.
        let origin = values(ORIGIN.as_str()).all(|origin| {
            origin.strip_prefix("http://").is_some_and(|origin| origin.eq_ignore_ascii_case(host))
        });
        let site = values("sec-fetch-site").all(|site| ["same-origin", "none"].contains(&site));
        self.is_known(host) && origin && site
    }

    fn is_known(&self, host: &str) -> bool {
        let Some((name, port)) = split(host) else { return false };
        // Browsers omit the default port.
        let port = port.unwrap_or(80);
        self.0.iter().any(|own| own.name.eq_ignore_ascii_case(name) && own.port.is_none_or(|own| own == port))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn admitted(hosts: &[&str], headers: &[(&'static str, &str)]) -> bool {
        let hosts: Vec<HostName> = hosts.iter().map(|host| host.parse().unwrap()).collect();
        let headers = headers.iter().map(|(name, value)| (name.parse().unwrap(), value.parse().unwrap()));
        Guard::new(4000, &hosts).admits(&headers.collect())
    }

    #[test]
    fn only_own_pages_and_programs_are_admitted() {
        assert!(admitted(&[], &[("host", "127.0.0.1:4000")]));
        assert!(admitted(&[], &[("host", "localhost:4000"), ("origin", "http://localhost:4000")]));
        assert!(admitted(&[], &[("host", "localhost:4000"), ("sec-fetch-site", "same-origin")]));
        for strange in [
            &[][..],
            &[("host", "127.0.0.1")],
            &[("host", "127.0.0.1:4001")],
            &[("host", "127.0.0.1:4000"), ("host", "127.0.0.1:4000")],
            &[("host", "elsewhere.example:4000")],
            &[("host", "127.0.0.1:4000"), ("origin", "http://elsewhere.example")],
            &[("host", "127.0.0.1:4000"), ("origin", "https://127.0.0.1:4000")],
            &[("host", "127.0.0.1:4000"), ("origin", "http://127.0.0.1:4001")],
            &[("host", "127.0.0.1:4000"), ("origin", "null")],
            &[("host", "127.0.0.1:4000"), ("sec-fetch-site", "cross-site")],
            &[("host", "127.0.0.1:4000"), ("sec-fetch-site", "same-site")],
        ] {
            assert!(!admitted(&[], strange), "{strange:?}");
        }
    }

    /// Checks all hosts with all origins: only a known host with its own origin or without an origin is admitted.
    #[test]
    fn allowed_hosts_are_checked_like_own_hosts() {
        let known = ["127.0.0.1:4000", "localhost:4000", "LocalHost:9000", "desk:1", "Desk", "[::1]:7"];
        let strange =
            ["localhost:9001", "localhost", "desk.example", "[::1]", "[::1]:8", "", "desk:x", "127.0.0.1"];
        for host in known.iter().chain(&strange) {
            for origin in known.iter().chain(&strange).map(Some).chain([None]) {
                let url = origin.map(|origin| format!("http://{origin}"));
                let headers = [("host", *host), ("origin", url.as_deref().unwrap_or_default())];
                let headers = &headers[..if origin.is_some() { 2 } else { 1 }];
                let expected = known.contains(host) && origin.is_none_or(|origin| origin == host);
                let allowed = ["localhost:9000", "desk", "[::1]:7"];
                assert_eq!(admitted(&allowed, headers), expected, "{host} {origin:?}");
            }
        }
        for wrong in ["", ":80", "http://desk", "desk/", "desk:", "desk:70000", "a b", "*", "[x]"] {
            assert_eq!(wrong.parse::<HostName>(), Err(NoHostName), "{wrong}");
        }
    }
}
