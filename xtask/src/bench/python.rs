//! numpy and scipy, in a Python process that solves its routes in every round.

use std::io::{BufRead, BufReader, Error, ErrorKind, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use cea::StandardForm;
use num_complex::Complex;
use serde::Deserialize;
use validation::Spectra;

use super::problems::Problem;

/// The script of the Python process, which measures its own times.
const SCRIPT: &str = include_str!("python.py");

/// A Python process that holds the scaled state matrices of one problem.
pub struct Python {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    /// Names of the routes.
    pub routes: Vec<String>,
    /// The eigenvalues that each route found.
    pub spectra: Vec<Spectra>,
}

/// The first line that the script writes.
#[derive(Deserialize)]
struct Greeting {
    routes: Vec<String>,
    /// Scaled eigenvalues by route, system and place, real and imaginary part.
    spectra: Vec<Vec<Vec<[f64; 2]>>>,
}

impl Python {
    /// Starts `python3` and hands the state matrices over.
    ///
    /// # Errors
    /// [`ErrorKind::NotFound`] where there is no Python; the message of Python where it has no numpy.
    pub fn start(problem: &Problem) -> Result<Self, Error> {
        let forms = problem.systems.iter().map(StandardForm::new).collect::<Result<Vec<_>, _>>();
        let forms = forms.map_err(Error::other)?;
        let order = 2 * problem.n + problem.states;
        let mut child = Command::new("python3")
            .args(["-c", SCRIPT, &forms.len().to_string(), &order.to_string()])
            .envs(["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"].map(|name| (name, "1")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| Error::new(error.kind(), format!("python3 cannot be started: {error}")))?;
        let pipe = |name: &str| Error::new(ErrorKind::BrokenPipe, format!("python3 has no {name}"));
        let mut input = child.stdin.take().ok_or_else(|| pipe("input"))?;
        let mut output = BufReader::new(child.stdout.take().ok_or_else(|| pipe("output"))?);
        let bytes: Vec<u8> = forms.iter().flat_map(|form| form.state.iter()).flat_map(|x| x.to_le_bytes()).collect();
        // If Python has ended early, the line read next gives the reason.
        let _ = input.write_all(&bytes).and_then(|()| input.flush());
        let mut line = String::new();
        output.read_line(&mut line)?;
        let Ok(greeting) = serde_json::from_str::<Greeting>(&line) else {
            let said = child.wait_with_output()?.stderr;
            let said = String::from_utf8_lossy(&said);
            return Err(Error::other(said.trim().lines().last().unwrap_or("python3 says nothing").to_owned()));
        };
        let spectrum = |(sigmas, form): (&Vec<[f64; 2]>, &StandardForm)| {
            Some(sigmas.iter().map(|&[re, im]| Complex::new(re, im) * form.gamma).collect())
        };
        let spectra = greeting.spectra.iter().map(|route| route.iter().zip(&forms).map(spectrum).collect()).collect();
        Ok(Self { child, input, output, routes: greeting.routes, spectra })
    }

    /// The time of a route for all systems, seconds.
    ///
    /// # Errors
    /// The process ended.
    pub fn time(&mut self, route: usize) -> Result<f64, Error> {
        writeln!(self.input, "{route}")?;
        self.input.flush()?;
        let mut line = String::new();
        self.output.read_line(&mut line)?;
        line.trim().parse().map_err(Error::other)
    }
}

impl Drop for Python {
    fn drop(&mut self) {
        // The process waits for the next route.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
