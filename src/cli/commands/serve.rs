//! `pcc serve`

use crate::cli::inputs::read_surrogate;
use crate::cli::{Context, Ending};
use crate::report::ServeReport;
use crate::serve::{Limits, Models, Server, answer};
use anyhow::Context as _;
use clap::Args;
use pcc_evaluate::foundation::{Observer, plural};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;

/// What the help ends with.
const EXAMPLES: &str = "\
Examples:
  pcc serve belt.pcc            models eigenvalues, max_re and verdict at http://127.0.0.1:4242
  pcc serve belt.pcc --port 0   at any free port, which is printed";

/// Let other programs ask a surrogate over HTTP, by the protocol UM-Bridge
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Options {
    /// Surrogate file
    pub surrogate: PathBuf,

    /// Port to listen at; 0 for any that is free
    #[arg(long, default_value_t = 4242)]
    pub port: u16,

    /// Address to listen at: 0.0.0.0 lets other machines ask as well
    #[arg(long, value_name = "IP", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    pub address: IpAddr,
}

pub(super) fn run(context: &Context, options: &Options) -> anyhow::Result<Ending> {
    let surrogate = read_surrogate(&options.surrogate)?.surrogate;
    let models = Models::new(&surrogate);
    let address = SocketAddr::new(options.address, options.port);
    let server = Server::bind(address, Limits::DEFAULT).with_context(|| {
        format!("cannot listen at {address}; choose another --port, or 0 for any that is free, and an --address of this machine")
    })?;
    if !options.address.is_loopback() {
        context.say("warning: whoever reaches this machine can ask the surrogate; there is no password");
    }
    context.print(&ServeReport::new(&models, options.surrogate.display().to_string(), server.address()))?;
    let answered = server.run(|request| answer(&models, request), || context.terminal.interrupted());
    context.say(&format!("{} answered", plural(answered as usize, "request")));
    Ok(Ending::Interrupted)
}
