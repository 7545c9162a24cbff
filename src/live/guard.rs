//! Request filter that admits pages served by this server, and programs on the same machine.
//!
//! A page of another origin can make a browser send requests to this server. It can hide neither its origin (`Origin`, `Sec-Fetch-Site`)
//! nor, if its name resolves to this machine, that name (`Host`).

use std::str::FromStr;

use axum::http::header::{HOST, HeaderMap, ORIGIN};

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
pub(super) struct Guard(Vec<HostName>);

impl Guard {
    /// Creates the guard of the server at `port`, which may also be addressed by `hosts`.
    pub(super) fn new(port: u16, hosts: &[HostName]) -> Self {
        let own = |name: &str, port| HostName { name: name.to_owned(), port };
        let mut all = hosts.to_vec();
        all.extend(["127.0.0.1", "localhost"].map(|name| own(name, Some(port))));
        Self(all)
    }

    /// Returns whether a request comes from the server's own pages, or from no page at all.
    pub(super) fn admits(&self, headers: &HeaderMap) -> bool {
        let values = |name| headers.get_all(name).iter().map(|value| value.to_str().unwrap_or_default());
        let mut hosts = values(HOST.as_str());
        let (Some(host), None) = (hosts.next(), hosts.next()) else { return false };
        // A page sends its requests to the host that served it.
        let origin = values(ORIGIN.as_str()).all(|origin| {
            origin.strip_prefix("http://").is_some_and(|origin| origin.eq_ignore_ascii_case(host))
        });
        let site = values("sec-fetch-site").all(|site| ["same-origin", "none"].contains(&site));
        self.knows(host) && origin && site
    }

    fn knows(&self, host: &str) -> bool {
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
    fn only_its_own_pages_and_no_pages_are_admitted() {
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
    fn names_that_are_allowed_are_checked_like_its_own() {
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
