//! The process of LAMMPS, its pipe, and its end.

use crate::folder::Folder;
use crate::refusal::refused;
use grainlab_core::EngineProgram;
use grainlab_engine::EngineError;
use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Lines of output that an error quotes at most.
const QUOTED: usize = 16;

/// Lines of output that wait to be read at most.
const WAITING: usize = 1000;

/// Time for a process that has no more input to end by itself.
const FAREWELL: Duration = Duration::from_secs(2);

/// Variable of the environment with the folder of a program, by which its processes are found.
const MARK: &str = "GRAINLAB_ENGINE";

/// Commands of a scene that need a package or a version of LAMMPS.
const NEEDS: &str = "atom_style sphere\nregion all block 0 1 0 1 0 1\ncreate_box 1 all\npair_style granular\n\
     pair_coeff * * hertz/material 1 0.5 0.2 tangential linear_nohistory 0 0 damping coeff_restitution limit_damping\n";

/// A running LAMMPS. It ends when this is dropped, and by itself when our process has ended, since its input ends then.
#[derive(Debug)]
pub(crate) struct Program {
    child: Child,
    input: Option<ChildStdin>,
    output: Receiver<String>,
    last: VecDeque<String>,
    command: String,
    /// Entry of the environment of all its processes, and of no others.
    mark: String,
    limit: Duration,
    questions: u64,
}

impl Program {
    /// Starts `command`, an `lmp` with what starts it (`mpiexec -n 2 lmp`), with a time limit for each answer. With its end the
    /// folder is removed, also after the end of our process.
    pub(crate) fn start(
        command: &str,
        limit: Duration,
        folder: &Folder,
    ) -> Result<(Self, EngineProgram), EngineError> {
        if command.trim().is_empty() {
            return refused("engine_command is empty; it names the program, as in 'mpiexec -n 4 lmp'");
        }
        // The trap keeps the shell until a program that is asked to end has ended.
        let script = format!(
            "trap : TERM\n{command} -nb -nocite -log none -echo none\ncode=$?\nrm -rf \"${MARK}\"\nexit $code"
        );
        let child = Command::new("sh")
            .args(["-c", &script])
            .env("OMP_NUM_THREADS", std::env::var("OMP_NUM_THREADS").unwrap_or_else(|_| "1".into()))
            .env(MARK, folder.path())
            // By default srun copies the input to all processes, of which only the first reads it; when the pipe of another one is
            // full, the run hangs. And it does not end the other processes if one fails.
            .env("SLURM_STDINMODE", "0")
            .env("SLURM_KILL_BAD_EXIT", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            // A group of its own: with mpiexec it is several processes, and Ctrl-C is not for it.
            .process_group(0)
            .spawn();
        let mut child = child.or_else(|error| refused(format!("`{command}` cannot be started: {error}")))?;
        let (lines, output) = sync_channel(WAITING);
        if let Some(stdout) = child.stdout.take() {
            forward(stdout, "", lines.clone());
        }
        if let Some(stderr) = child.stderr.take() {
            // Answers are on the standard output alone.
            forward(stderr, " ", lines);
        }
        let input = child.stdin.take();
        let (command, mark) = (command.to_owned(), format!("{MARK}={}", folder.path().display()));
        let mut program =
            Self { child, input, output, last: VecDeque::new(), command, mark, limit, questions: 0 };
        let about = program.about()?;
        Ok((program, about))
    }

    fn about(&mut self) -> Result<EngineProgram, EngineError> {
        self.tell(&format!("{NEEDS}info communication\n"))?;
        let mut ranks = None;
        let version = self.answer("$(version)", |line| {
            let count = line.strip_prefix("Nprocs = ").and_then(|rest| rest.split(',').next());
            ranks = ranks.or(count.and_then(|n| n.parse().ok()));
        })?;
        self.tell("clear\n")?;
        let (Some(version), Some(ranks)) = (version.first(), ranks) else {
            return self.failed("it does not state its version and its number of processes");
        };
        Ok(EngineProgram { name: crate::refusal::NAME.into(), version: version.clone(), ranks })
    }

    /// Sends commands. Their errors are found by the next [`Program::ask`].
    pub(crate) fn tell(&mut self, commands: &str) -> Result<(), EngineError> {
        let sent = self.input.as_mut().map(|input| input.write_all(commands.as_bytes()));
        match sent {
            Some(Ok(())) => Ok(()),
            // The reason is in what it printed before it ended.
            _ => self.answer("", |_| {}).map(drop),
        }
    }

    /// The values of these variables (`$(lx)`, `$(c_p[1])`) once all commands sent are done; without variables, a wait for that.
    pub(crate) fn ask<const N: usize>(&mut self, variables: [&str; N]) -> Result<[f64; N], EngineError> {
        let words = variables.map(|v| format!("$({v}:%.17g)")).join(" ");
        let words = self.answer(&words, |_| {})?;
        let numbers: Vec<f64> = words.iter().map(|word| word.parse().unwrap_or(f64::NAN)).collect();
        let Ok(numbers) = <[f64; N]>::try_from(numbers) else {
            return self.failed(&format!("it answered {words:?}"));
        };
        Ok(numbers)
    }

    fn answer(&mut self, text: &str, mut see: impl FnMut(&str)) -> Result<Vec<String>, EngineError> {
        self.questions += 1;
        let mark = format!("@{}:", self.questions);
        let question = format!("print \"{mark} {text}\"\n");
        let asked = self.input.as_mut().is_some_and(|input| input.write_all(question.as_bytes()).is_ok());
        let (mut end, mut reported) = (Instant::now() + self.limit, false);
        loop {
            let left = end.saturating_duration_since(Instant::now());
            // recv_timeout takes a line that waits also without time left, and a program may print without end.
            let line =
                if left.is_zero() { Err(RecvTimeoutError::Timeout) } else { self.output.recv_timeout(left) };
            match line {
                Ok(line) => {
                    if let Some(words) = line.strip_prefix(&mark).filter(|_| asked) {
                        return Ok(words.split_whitespace().map(str::to_owned).collect());
                    }
                    if line.starts_with('@') {
                        self.kill();
                        return self.failed(
                            "several programs answer: its processes are not one LAMMPS. Under srun, --mpi must name the interface of \
                             the program's MPI (srun --mpi=pmi2)",
                        );
                    }
                    see(&line);
                    // It ends after an error, though what started it may not.
                    if line.starts_with("ERROR") && !reported {
                        (end, reported) = (Instant::now() + FAREWELL, true);
                    }
                    self.last.push_back(line);
                    if self.last.len() > QUOTED {
                        self.last.pop_front();
                    }
                }
                Err(RecvTimeoutError::Timeout) if reported => {
                    self.kill();
                    return self.failed("it stopped with an error");
                }
                Err(RecvTimeoutError::Timeout) => {
                    let limit = self.limit.as_secs_f64();
                    self.kill();
                    return self.failed(&format!(
                        "it did not answer within {limit} s, and was ended (parameter engine_time_limit)"
                    ));
                }
                Err(RecvTimeoutError::Disconnected) => {
                    self.input = None;
                    let status = self.child.wait().map_or_else(|e| e.to_string(), |s| s.to_string());
                    self.end_rest();
                    return self.failed(&format!("it ended ({status})"));
                }
            }
        }
    }

    /// The error, with the last lines of output.
    fn failed<T>(&self, what: &str) -> Result<T, EngineError> {
        let lines: Vec<&str> = self
            .last
            .iter()
            .map(|l| l.trim())
            .filter(|l| !l.is_empty() && !l.contains("^^") && !is_step(l))
            .collect();
        // Errors of LAMMPS and of MPI.
        let begins = |l: &&str| l.contains("ERROR") || l.starts_with("Abort(");
        let from = lines.iter().position(begins).unwrap_or(lines.len().saturating_sub(3));
        let lines = &lines[from..];
        let quoted = if lines.is_empty() { String::new() } else { format!(": {}", lines.join(" | ")) };
        let reason = format!("`{}`: {what}{quoted}", self.command);
        Err(EngineError::Lost { engine: crate::refusal::NAME.into(), reason })
    }

    fn ends_within(&mut self, limit: Duration) -> bool {
        let end = Instant::now() + limit;
        while Instant::now() < end {
            if matches!(self.child.try_wait(), Ok(Some(_))) {
                return true;
            }
            thread::sleep(Duration::from_millis(5));
        }
        false
    }

    fn kill(&mut self) {
        self.input = None;
        // srun ends its processes on other hosts where it is asked to end, and leaves them where it is killed.
        signal(&marked(&self.mark), libc::SIGTERM);
        let _ = self.ends_within(FAREWELL);
        self.end_rest();
        let _ = self.child.wait();
    }

    /// Ends what is left of its processes. mpiexec gives them groups of their own, and its end may leave one without a parent.
    fn end_rest(&self) {
        // The group has also what has cleared its environment.
        if let Ok(group) = i32::try_from(self.child.id()) {
            // SAFETY: killpg takes two integers.
            unsafe { libc::killpg(group, libc::SIGKILL) };
        }
        signal(&marked(&self.mark), libc::SIGKILL);
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let Some(mut input) = self.input.take() else { return };
        let _ = input.write_all(b"quit\n");
        drop(input);
        if self.ends_within(FAREWELL) {
            self.end_rest();
        } else {
            self.kill();
        }
    }
}

fn signal(processes: &[u32], signal: i32) {
    for process in processes.iter().filter_map(|id| i32::try_from(*id).ok()) {
        // SAFETY: kill takes two integers. The processes ran a moment ago, so that their ids are still their own.
        unsafe { libc::kill(process, signal) };
    }
}

/// The processes whose environment has this entry.
fn marked(entry: &str) -> Vec<u32> {
    let processes = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let is_marked = |id: &u32| {
        let environment = std::fs::read(format!("/proc/{id}/environ")).unwrap_or_default();
        environment.split(|byte| *byte == 0).any(|other| other == entry.as_bytes())
    };
    processes.filter_map(|process| process.file_name().to_str()?.parse().ok()).filter(is_marked).collect()
}

/// True for a line of the table of steps.
fn is_step(line: &str) -> bool {
    line == "Step" || line.parse::<u64>().is_ok()
}

/// Sends each line of a stream, in a thread that ends with the stream.
fn forward(stream: impl Read + Send + 'static, before: &'static str, lines: SyncSender<String>) {
    thread::spawn(move || {
        let mut stream = BufReader::new(stream);
        let mut bytes = Vec::new();
        while stream.read_until(b'\n', &mut bytes).is_ok_and(|read| read > 0) {
            let line = format!("{before}{}", String::from_utf8_lossy(&bytes).trim_end());
            bytes.clear();
            if lines.send(line).is_err() {
                return;
            }
        }
    });
}
