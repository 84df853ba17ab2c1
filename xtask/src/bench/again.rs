//! The bench in a process of its own, where this one was built or started otherwise than it needs.

use std::io::Error;
use std::process::Command;

use super::BenchArgs;

/// The bench built with other features, or this one with OpenBLAS on one thread: it reads their number when it is loaded.
pub fn again(args: &BenchArgs) -> Option<Result<Command, Error>> {
    const THREADS: &str = "OPENBLAS_NUM_THREADS";
    let command = if let Some(features) = &args.features {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        cargo.args(["run", "--release", "--package", "xtask", "--features", features, "--", "bench"]);
        cargo.args(args.quick.then_some("--quick"));
        cargo.args(args.samples.map(|samples| format!("--samples={samples}")));
        cargo.args(args.json.iter().flat_map(|path| ["--json".as_ref(), path.as_os_str()]));
        // What cargo says of this package would make it build some of the others once more.
        for (name, _) in std::env::vars_os() {
            let is_own = |name: &str| name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_");
            if name.to_str().is_some_and(is_own) {
                cargo.env_remove(name);
            }
        }
        Ok(cargo)
    } else if cfg!(feature = "lapack") && std::env::var_os(THREADS).is_none_or(|threads| threads != "1") {
        std::env::current_exe().map(|program| {
            let mut same = Command::new(program);
            same.args(std::env::args_os().skip(1));
            same
        })
    } else {
        return None;
    };
    Some(command.map(|mut command| {
        command.env(THREADS, "1");
        command
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_and_the_other_options_reach_cargo() {
        let args =
            BenchArgs { features: Some("faer".into()), json: Some("a b.json".into()), samples: Some(5), quick: true };
        let command = again(&args).unwrap().unwrap();
        let words: Vec<_> = command.get_args().map(|word| word.to_str().unwrap()).collect();
        let [cargo, bench] = words.split(|&word| word == "--").collect::<Vec<_>>()[..] else { unreachable!() };
        assert_eq!(cargo, ["run", "--release", "--package", "xtask", "--features", "faer"]);
        assert_eq!(bench, ["bench", "--quick", "--samples=5", "--json", "a b.json"]);
        assert!(command.get_envs().any(|(name, value)| name == "OPENBLAS_NUM_THREADS" && value == Some("1".as_ref())));
    }
}
