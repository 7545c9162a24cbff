//! The pages of the gallery.

use std::fmt::Write;

use rayreel::time::FrameList;
use rayreel::trace::SimdLevel;

use super::exhibit::{Exhibit, Movie, Span, Still};
use super::source::{beginning, escaped, highlighted, prose};

/// The style of the pages of `rayreel accuracy`, and what the gallery adds.
const STYLE: &str = concat!(include_str!("../../../src/cli/accuracy/page.css"), include_str!("page.css"));

/// Plays the loop while it is in view, unless reduced motion is preferred.
const PLAY: &str = "const loop = document.querySelector('video');\n\
    if (loop && matchMedia('(prefers-reduced-motion: no-preference)').matches) {\n\
    new IntersectionObserver(([seen]) => seen.isIntersecting ? loop.play().catch(() => {}) : loop.pause()).observe(loop);\n}";

/// Returns a page. Pictures are files beside it, so that each is loaded only when it is shown.
fn page(title: &str, body: &str) -> String {
    let title = escaped(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}</body>\n</html>\n"
    )
}

/// Returns the page with the stills of all scenes.
pub(crate) fn index(exhibits: &[Exhibit]) -> String {
    let mut body = format!(
        "<h1>rayreel gallery</h1>\n<p class=\"dim\">{}</p>\n<main class=\"cards\">\n",
        escaped(&format!("The scenes of the repository, rendered by rayreel {}.", machine()))
    );
    for exhibit in exhibits {
        let Exhibit { id, title, still, size: (width, height), .. } = exhibit;
        let title = escaped(title);
        let _ = writeln!(
            body,
            "<a href=\"{id}.html\"><img src=\"{file}\" width=\"{width}\" height=\"{height}\" loading=\"lazy\" alt=\"{about}\">\
             <strong>{title}</strong><span class=\"dim\">{seconds} a frame</span></a>",
            file = still.file,
            about = escaped(exhibit.sentence()),
            seconds = time(exhibit.median())
        );
    }
    body += "</main>\n";
    page("rayreel gallery", &body)
}

/// Returns the page of the scene with this index.
pub(crate) fn scene(exhibits: &[Exhibit], index: usize) -> String {
    let exhibit = &exhibits[index];
    let link = |exhibit: Option<&Exhibit>, rel: &str, arrow: [&str; 2]| {
        exhibit.map_or_else(String::new, |Exhibit { id, title, .. }| {
            format!("<a rel=\"{rel}\" href=\"{id}.html\">{}{}{}</a>\n", arrow[0], escaped(title), arrow[1])
        })
    };
    let mut body = format!(
        "<nav>\n<a href=\"index.html\">Gallery</a>\n{}{}</nav>\n<main>\n<h1>{}</h1>\n<p>{}</p>\n",
        link(index.checked_sub(1).and_then(|before| exhibits.get(before)), "prev", ["← ", ""]),
        link(exhibits.get(index + 1), "next", ["", " →"]),
        escaped(&exhibit.title),
        prose(&exhibit.about)
    );
    pictures(&mut body, exhibit);
    facts(&mut body, exhibit);
    body += "<h2>Plan</h2>\n";
    let plan = exhibit.plan.iter();
    let rows: Vec<_> =
        plan.flat_map(|(effect, spans)| spans.iter().map(|span| (effect.name(), span))).collect();
    for (head, is_needed) in [("needed", true), ("omitted", false)] {
        let rows = rows.iter().filter(|(_, span)| span.need.is_needed() == is_needed);
        table(&mut body, head, rows, exhibit.seconds.len());
    }
    body += "<h2>Source</h2>\n";
    for (index, (path, text)) in exhibit.sources.iter().enumerate() {
        let path = escaped(&path.display().to_string());
        let (shown, left_out) = beginning(text);
        let source = highlighted(shown);
        let mut code =
            format!("<pre tabindex=\"0\" role=\"region\" aria-label=\"{path}\"><code>{source}</code></pre>");
        if left_out > 0 {
            let _ = write!(code, "\n<p class=\"dim\">and {left_out} more lines</p>");
        }
        let _ = match index {
            0 => writeln!(body, "<p class=\"dim\">{path}</p>\n{code}"),
            _ => writeln!(body, "<details><summary>{path}</summary>\n{code}\n</details>"),
        };
    }
    let _ = writeln!(body, "</main>\n<script>\n{PLAY}\n</script>");
    page(&format!("{} · rayreel gallery", exhibit.title), &body)
}

fn pictures(body: &mut String, exhibit: &Exhibit) {
    let Exhibit { title, size: (width, height), still: Still { file, frame }, movie, .. } = exhibit;
    let (title, size) = (escaped(title), format!("width=\"{width}\" height=\"{height}\""));
    let image = format!("<img src=\"{file}\" {size} alt=\"{title}: frame {frame}\">");
    let _ = match movie {
        // Nothing of a movie is loaded before it plays.
        Some(Movie { file: movie, .. }) if movie.ends_with(".mp4") => writeln!(
            body,
            "<video src=\"{movie}\" poster=\"{file}\" {size} preload=\"none\" controls loop muted playsinline \
             aria-label=\"{title}: the whole scene, as a loop without sound\"></video>"
        ),
        Some(Movie { file: movie, .. }) => writeln!(
            body,
            "{image}\n<details><summary>Play the loop</summary>\n\
             <img src=\"{movie}\" {size} loading=\"lazy\" alt=\"{title}: the whole scene, as a loop\">\n</details>"
        ),
        None => writeln!(body, "{image}"),
    };
}

fn facts(body: &mut String, exhibit: &Exhibit) {
    let Exhibit { size: (width, height), samples, movie, seconds, .. } = exhibit;
    let (least, most) = (seconds.first().copied().unwrap_or(0.0), seconds.last().copied().unwrap_or(0.0));
    let range = match seconds.len() {
        0 | 1 => String::new(),
        count => format!(", from {} to {} in {count} frames", time(least), time(most)),
    };
    let mut facts = vec![
        ("Picture", format!("{width} × {height} pixels, {samples} each")),
        ("Time", format!("{} a frame{range}, by rayreel {}", time(exhibit.median()), machine())),
    ];
    if let Some(Movie { frames, of, seconds, .. }) = movie {
        facts.push(("Loop", format!("{seconds:.1} s, frames {frames} of {of}")));
    }
    *body += "<dl>\n";
    for (name, value) in facts {
        let _ = writeln!(body, "<dt>{name}</dt><dd>{}</dd>", escaped(&value));
    }
    *body += "</dl>\n";
}

/// Adds a table of effects, if there are any.
fn table<'a>(
    body: &mut String,
    head: &str,
    rows: impl Iterator<Item = &'a (&'static str, &'a Span)>,
    all: usize,
) {
    let rows = rows.map(|(effect, span)| {
        let frames = if span.frames.len() == all {
            "all".to_owned()
        } else {
            FrameList::of(span.frames.iter().copied()).map_or_else(String::new, |frames| frames.to_string())
        };
        format!("<tr><td>{effect}</td><td>{frames}</td><td>{}</td></tr>\n", prose(span.need.reason()))
    });
    let rows: String = rows.collect();
    if !rows.is_empty() {
        let _ = writeln!(
            body,
            "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Effects that are {head}\"><table class=\"plan\">\n\
             <tr><th>{head}</th><th>frames</th><th>why</th></tr>\n{rows}</table></div>"
        );
    }
}

impl Exhibit {
    /// Returns the median time of a frame in seconds.
    fn median(&self) -> f64 {
        self.seconds.get(self.seconds.len() / 2).copied().unwrap_or(0.0)
    }

    /// Returns the first sentence about the scene, or its title.
    fn sentence(&self) -> &str {
        let end = self.about.find(". ").map_or(self.about.len(), |end| end + 1);
        if end > 0 { &self.about[..end] } else { &self.title }
    }
}

/// Formats a time.
fn time(seconds: f64) -> String {
    if seconds < 0.1 { format!("{:.1} ms", 1e3 * seconds) } else { format!("{seconds:.2} s") }
}

/// Describes the program and the machine, as `0.1.0 on 2 threads with AVX2 of an Epyc`.
fn machine() -> String {
    let threads = match rayon::current_num_threads() {
        1 => "1 thread".to_owned(),
        count => format!("{count} threads"),
    };
    let level = SimdLevel::all().last().map_or("baseline", |(name, _)| name);
    let processors = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let processor = processors.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let processor = processor.map_or(std::env::consts::ARCH, |(_, name)| name);
    format!("{} on {threads} of {processor}, vectors: {level}", env!("CARGO_PKG_VERSION"))
}
