//! Files of the page.

/// Path, media type and content of each file.
pub(super) const FILES: [(&str, &str, &str); 9] = [
    ("/", "text/html; charset=utf-8", include_str!("page/page.html")),
    ("/page.css", "text/css; charset=utf-8", include_str!("page/page.css")),
    ("/page.js", SCRIPT, include_str!("page/page.js")),
    ("/timeline.js", SCRIPT, include_str!("page/timeline.js")),
    ("/picture.js", SCRIPT, include_str!("page/picture.js")),
    ("/panels.js", SCRIPT, include_str!("page/panels.js")),
    ("/curve.js", SCRIPT, include_str!("page/curve.js")),
    ("/hands.js", SCRIPT, include_str!("page/hands.js")),
    ("/news.js", SCRIPT, include_str!("page/news.js")),
];

const SCRIPT: &str = "text/javascript; charset=utf-8";
