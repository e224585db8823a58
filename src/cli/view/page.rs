//! The page of a view: its address, and the threads that serve it.

use super::args::ViewerArgs;
use super::host::{Host, Input};
use super::http::Door;
use super::listen::serve;
use super::options::Options;
use super::state::greeting;
use super::token::token;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::render::RenderSetup;
use crate::cli::source::Source;
use std::env;
use std::fs::{File, Metadata};
use std::io::ErrorKind;
use std::net::{IpAddr, SocketAddr, TcpListener, ToSocketAddrs};
use std::sync::Arc;
use std::sync::mpsc::sync_channel;
use std::thread;

/// The address of this machine for itself.
const LOOPBACK: &str = "127.0.0.1";

/// Maximum number of inputs that wait: pages that send more wait, too.
pub(super) const QUEUE_LENGTH: usize = 256;

/// Serves the page of the setup's scene, opens a browser where there is a display, and runs until the process ends.
///
/// # Errors
/// The address cannot be listened at, or the scene cannot be loaded.
pub(super) fn open(
    setup: &RenderSetup,
    args: &ViewerArgs,
    options: Options,
) -> Result<(), Failure> {
    check(&setup.source)?;
    let name = args.address.as_deref().unwrap_or(LOOPBACK);
    let listener = listen(name, args.port.unwrap_or(0))?;
    let at = listener.local_addr().map_err(|error| Failure::View(format!("{name}: {error}")))?;
    let token = token(args.port.filter(|port| *port > 0))?;
    let (sender, inputs) = sync_channel::<Input>(QUEUE_LENGTH);
    let host = Host::start(setup, options, greeting()?, &sender)?;
    announce(name, at, &token, args.no_browser);
    let door = Arc::new(Door { token, address: name.to_owned() });
    thread::spawn(move || serve(&listener, &door, &sender));
    host.run(&inputs)
}

/// Returns an error if a file is missing or cannot be opened, before an address is told at which nothing would be seen.
fn check(source: &Source) -> Result<(), Failure> {
    let (Source::Toml(path) | Source::Particles(path, _)) = source else { return Ok(()) };
    // Pipes are opened once.
    let is_there = |data: Metadata| !data.is_file() || File::open(path).is_ok();
    if path.as_os_str() == "-" || path.metadata().is_ok_and(is_there) {
        return Ok(());
    }
    Ok(source.load().map(drop)?)
}

fn listen(name: &str, port: u16) -> Result<TcpListener, Failure> {
    let failed = |error: std::io::Error| {
        Failure::View(match error.kind() {
            ErrorKind::AddrInUse => format!(
                "port {port} is in use; choose another one with --port, or leave it out for a free one"
            ),
            ErrorKind::PermissionDenied => {
                format!("port {port} needs the rights of an administrator; choose one from 1024")
            }
            _ => format!(
                "--address {name}: {error}; give an address of this machine, as in 127.0.0.1"
            ),
        })
    };
    let places: Vec<SocketAddr> = (name, port).to_socket_addrs().map_err(failed)?.collect();
    TcpListener::bind(&places[..]).map_err(failed)
}

/// Prints the address, and opens it in a browser where there is a display.
fn announce(name: &str, at: SocketAddr, token: &str, no_browser: bool) {
    let host = match name.parse() {
        Ok(IpAddr::V6(_)) => format!("[{name}]"),
        _ => name.to_owned(),
    };
    let port = at.port();
    let address = format!("http://{host}:{port}/{token}/");
    output::print(&address);
    if !at.ip().is_loopback() {
        output::warn(
            "the page is not encrypted: others on the network can read it; leave out --address, and use ssh -L",
        );
        return;
    }
    let display = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| env::var_os(name).is_some());
    if no_browser {
        return;
    }
    if display || cfg!(target_os = "macos") {
        if let Err(error) = open::that_detached(&address) {
            output::note(format_args!("no browser opens: {error}; open the address above"));
        }
        return;
    }
    let machine = login();
    output::note(format_args!(
        "to see it on another machine, run there: ssh -L {port}:{LOOPBACK}:{port} {machine}   and open the address above"
    ));
}

/// The user and the name of this machine, as `ssh` takes them.
#[cfg(unix)]
fn login() -> String {
    let machine = rustix::system::uname().nodename().to_string_lossy().into_owned();
    let user = env::var("USER").or_else(|_| env::var("LOGNAME"));
    user.map_or(machine.clone(), |user| format!("{user}@{machine}"))
}

/// A name that stands for this machine.
#[cfg(not(unix))]
fn login() -> String {
    "this-machine".to_owned()
}
