//! A file of settings: what neither an argument nor a variable of the environment says of a service or a worker.

use super::Arguments;
use clap::{Command, CommandFactory, FromArgMatches};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::PathBuf;

/// Commands that take such a file.
const COMMANDS: [&str; 3] = ["serve", "worker", "demo"];
const OPTION: &str = "--config";
const VARIABLE: &str = "TRACKLOOM_CONFIG";

/// The arguments of the process. What is wrong with them ends it, as does a call for help.
///
/// # Errors
/// The file cannot be read, or is wrong: all its faults with their lines.
pub(super) fn arguments() -> Result<Arguments, String> {
    let mut command = Arguments::command();
    if let Some(path) = named_file(std::env::args_os(), std::env::var_os(VARIABLE)) {
        let text = std::fs::read_to_string(&path);
        let text = text.map_err(|error| format!("cannot read {}: {error}", path.display()))?;
        let settings = read(&text, &names(&command));
        let settings = settings
            .map_err(|faults| format!("{} is wrong\n  {}", path.display(), faults.join("\n  ")))?;
        command = with_defaults(command, &settings);
    }
    let matches = command.get_matches();
    Ok(Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit()))
}

/// The file that an argument names, else the variable.
fn named_file(
    arguments: impl Iterator<Item = OsString>,
    variable: Option<OsString>,
) -> Option<PathBuf> {
    let mut arguments = arguments.skip(1).peekable();
    let command = arguments.peek()?.to_str()?;
    if !COMMANDS.contains(&command) {
        return None;
    }
    while let Some(argument) = arguments.next() {
        if argument == OPTION {
            return arguments.next().map(PathBuf::from);
        }
        let text = argument.to_str().and_then(|text| text.strip_prefix(OPTION));
        if let Some(path) = text.and_then(|text| text.strip_prefix('=')) {
            return Some(PathBuf::from(path));
        }
    }
    variable.map(PathBuf::from)
}

/// The variables of the commands.
fn names(command: &Command) -> Vec<String> {
    let mut names = Vec::new();
    for of in command.get_subcommands() {
        if COMMANDS.contains(&of.get_name()) {
            let variables = of.get_arguments().filter_map(clap::Arg::get_env);
            names.extend(variables.map(|name| name.to_string_lossy().into_owned()));
        }
    }
    names.retain(|name| name != VARIABLE);
    names.sort();
    names.dedup();
    names
}

/// Lines of `NAME=value`, as files of environments have them: blank lines and those that begin with `#` say nothing, quotes around a value are left out.
fn read(text: &str, known: &[String]) -> Result<BTreeMap<String, String>, Vec<String>> {
    let (mut settings, mut faults) = (BTreeMap::new(), Vec::new());
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let Some((name, value)) = line.split_once('=') else {
            faults.push(format!("line {number}: it is not NAME=value"));
            continue;
        };
        let (name, value) = (name.trim(), unquoted(value.trim()));
        if !known.iter().any(|known| known == name) {
            let allowed = known.join(", ");
            faults.push(format!(
                "line {number}: there is no '{name}'; allowed: {allowed}"
            ));
        } else if settings.insert(name.to_owned(), value.to_owned()).is_some() {
            faults.push(format!("line {number}: '{name}' was said before"));
        }
    }
    if faults.is_empty() {
        Ok(settings)
    } else {
        Err(faults)
    }
}

fn unquoted(value: &str) -> &str {
    for quote in ['"', '\''] {
        let inner = value
            .strip_prefix(quote)
            .and_then(|rest| rest.strip_suffix(quote));
        if let Some(inner) = inner {
            return inner;
        }
    }
    value
}

/// The commands with these values where nothing else says one.
fn with_defaults(mut command: Command, settings: &BTreeMap<String, String>) -> Command {
    for name in COMMANDS {
        command = command.mut_subcommand(name, |of| {
            of.mut_args(|argument| {
                let variable = argument
                    .get_env()
                    .map(|name| name.to_string_lossy().into_owned());
                match variable.and_then(|name| settings.get(&name)) {
                    Some(value) => argument.default_value(value.clone()).required(false),
                    None => argument,
                }
            })
        });
    }
    command
}

#[cfg(test)]
mod tests {
    use super::super::{Arguments, Command as Chosen};
    use super::*;

    fn serve(text: &str, arguments: &[&str]) -> super::super::Config {
        let command = Arguments::command();
        let settings = read(text, &names(&command)).unwrap();
        let all = ["trackloom", "serve"]
            .into_iter()
            .chain(arguments.iter().copied());
        let matches = with_defaults(command, &settings).get_matches_from(all);
        match Arguments::from_arg_matches(&matches).unwrap().command {
            Chosen::Serve(serve) => serve.config(),
            _ => unreachable!("it serves"),
        }
    }

    #[test]
    fn a_file_says_what_no_argument_says() {
        let text = "# of a service\n\nTRACKLOOM_LISTEN=127.0.0.1:9000\nTRACKLOOM_QUEUE_LIMIT = 7\n\
                    TRACKLOOM_ALLOW_HOST=\"a.example.org,b.example.org\"\n";
        let config = serve(text, &["--queue-limit", "9"]);
        assert_eq!(config.listen.port(), 9000);
        assert_eq!(config.queue_limit, 9, "the argument counts");
        assert_eq!(config.allowed_hosts, ["a.example.org", "b.example.org"]);
    }

    #[test]
    fn all_faults_are_told_with_their_lines() {
        let known = ["TRACKLOOM_LISTEN".to_owned()];
        let text = "TRACKLOOM_LISTEN=x\nlisten\nTRACKLOOM_LISTN=y\nTRACKLOOM_LISTEN=z";
        let faults = read(text, &known).unwrap_err();
        assert_eq!(
            faults,
            [
                "line 2: it is not NAME=value",
                "line 3: there is no 'TRACKLOOM_LISTN'; allowed: TRACKLOOM_LISTEN",
                "line 4: 'TRACKLOOM_LISTEN' was said before",
            ]
        );
    }

    #[test]
    fn the_file_is_named_by_an_argument_else_by_a_variable() {
        let named = |arguments: &[&str], variable: Option<&str>| {
            named_file(
                arguments.iter().map(OsString::from),
                variable.map(OsString::from),
            )
        };
        let (a, b) = (PathBuf::from("a"), PathBuf::from("b"));
        assert_eq!(
            named(&["t", "serve", "--config", "a"], Some("b")),
            Some(a.clone())
        );
        assert_eq!(named(&["t", "worker", "--config=a"], None), Some(a));
        assert_eq!(named(&["t", "serve"], Some("b")), Some(b));
        assert_eq!(named(&["t", "run", "x"], Some("b")), None);
        assert_eq!(named(&["t"], Some("b")), None);
    }

    /// `docs/options.md` and `docs/deploy/trackloom.env` are written from the command line: `TRACKLOOM_WRITE_OPTIONS=1` does.
    #[test]
    fn the_page_of_options_and_the_sample_file_are_true() {
        let command = Arguments::command();
        let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/docs");
        for (path, made) in [
            ("options.md", page(&command)),
            ("deploy/trackloom.env", sample(&command)),
        ] {
            let path = format!("{docs}/{path}");
            if std::env::var_os("TRACKLOOM_WRITE_OPTIONS").is_some() {
                std::fs::write(&path, &made).unwrap();
            }
            let kept = std::fs::read_to_string(&path).unwrap_or_default();
            assert!(kept == made, "{path} is not what the command line says");
        }
    }

    fn options(command: &Command, name: &str) -> Vec<[String; 4]> {
        let of = command.find_subcommand(name).unwrap();
        let told = of
            .get_arguments()
            .filter(|argument| !argument.is_hide_set());
        let mut options = Vec::new();
        for argument in told {
            let Some(long) = argument.get_long().filter(|long| *long != "help") else {
                continue;
            };
            let text = |value: Option<&std::ffi::OsStr>| {
                value
                    .map(|value| value.to_string_lossy().into_owned())
                    .unwrap_or_default()
            };
            let defaults = argument
                .get_default_values()
                .iter()
                .map(|value| text(Some(value)));
            let default = defaults.collect::<Vec<_>>().join(",");
            let help = argument
                .get_help()
                .map(ToString::to_string)
                .unwrap_or_default();
            let default = if default == "false" {
                String::new()
            } else {
                default
            };
            options.push([format!("--{long}"), text(argument.get_env()), default, help]);
        }
        options
    }

    fn page(command: &Command) -> String {
        let mut page = String::from(include_str!("options_head.md"));
        for name in ["serve", "worker"] {
            page.push_str(&format!("\n## trackloom {name}\n\n"));
            page.push_str("| option | variable | default | |\n|---|---|---|---|\n");
            for [option, variable, default, help] in options(command, name) {
                let quoted = |text: &str| match text {
                    "" => String::new(),
                    text => format!("`{text}`"),
                };
                let help = help.replace('|', "\\|").replace('\n', " ");
                let (variable, default) = (quoted(&variable), quoted(&default));
                page.push_str(&format!(
                    "| `{option}` | {variable} | {default} | {help} |\n"
                ));
            }
        }
        page
    }

    fn sample(command: &Command) -> String {
        let mut text = String::from(
            "# Settings of trackloom: trackloom serve --config FILE, EnvironmentFile= of systemd, env_file of Compose.\n",
        );
        for [_, variable, default, help] in options(command, "serve") {
            if !variable.is_empty() && variable != VARIABLE {
                let help = help.replace('\n', " ");
                text.push_str(&format!("\n# {help}.\n#{variable}={default}\n"));
            }
        }
        text
    }
}
