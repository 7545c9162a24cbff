//! Who may ask the server: pages that it served itself, and programs on the same machine.
//!
//! A page from elsewhere can make a browser send requests here. It cannot hide where it comes from (`Origin`,
//! `Sec-Fetch-Site`), nor, if it pretends to be here by name, what it is called (`Host`).

use axum::http::header::{HOST, HeaderMap, ORIGIN};

/// Is a request to the server at this port from its own pages, or from no page at all?
pub(super) fn admits(headers: &HeaderMap, port: u16) -> bool {
    let own = match port {
        // Browsers leave it out.
        80 => ["127.0.0.1".to_owned(), "localhost".to_owned()],
        port => [format!("127.0.0.1:{port}"), format!("localhost:{port}")],
    };
    let values = |name| headers.get_all(name).iter().map(|value| value.to_str().unwrap_or_default());
    let mut hosts = values(HOST.as_str());
    let host = hosts.next().is_some_and(|host| own.iter().any(|own| own == host)) && hosts.next().is_none();
    let origin = values(ORIGIN.as_str()).all(|origin| {
        origin.strip_prefix("http://").is_some_and(|origin| own.iter().any(|own| own == origin))
    });
    let site = values("sec-fetch-site").all(|site| ["same-origin", "none"].contains(&site));
    host && origin && site
}

#[cfg(test)]
mod tests {
    use super::*;

    fn admitted(headers: &[(&'static str, &str)]) -> bool {
        let headers = headers.iter().map(|(name, value)| (name.parse().unwrap(), value.parse().unwrap()));
        admits(&headers.collect(), 4000)
    }

    #[test]
    fn only_its_own_pages_and_no_pages_are_admitted() {
        assert!(admitted(&[("host", "127.0.0.1:4000")]));
        assert!(admitted(&[("host", "localhost:4000"), ("origin", "http://localhost:4000")]));
        assert!(admitted(&[("host", "localhost:4000"), ("sec-fetch-site", "same-origin")]));
        for strange in [
            &[][..],
            &[("host", "127.0.0.1")],
            &[("host", "127.0.0.1:4001")],
            &[("host", "elsewhere.example:4000")],
            &[("host", "127.0.0.1:4000"), ("origin", "http://elsewhere.example")],
            &[("host", "127.0.0.1:4000"), ("origin", "https://127.0.0.1:4000")],
            &[("host", "127.0.0.1:4000"), ("origin", "null")],
            &[("host", "127.0.0.1:4000"), ("sec-fetch-site", "cross-site")],
            &[("host", "127.0.0.1:4000"), ("sec-fetch-site", "same-site")],
        ] {
            assert!(!admitted(strange), "{strange:?}");
        }
    }
}
