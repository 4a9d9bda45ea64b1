// See call.h.
#include "tools/nrsfm-solve/call.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>
#include <utility>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/quantity.h"
#include "base/text.h"
#include "manifest/sections/sequence.h"
#include "nrsfm/files.h"
#include "nrsfm/manifest_sequences.h"
#include "nrsfm/solve/listing.h"
#include "nrsfm/solve/solution_file.h"

namespace gonio::tools::nrsfm_solve {

using namespace gonio::nrsfm;

namespace {

namespace fs = std::filesystem;
using cli::Type;

std::string all_ids() {
  std::string ids;
  for (const Solver* solver : all_solvers()) ids += (ids.empty() ? "" : ", ") + solver->info().id;
  return ids;
}

std::vector<const Solver*> solvers_asked(const cli::Invocation& call) {
  std::vector<const Solver*> asked;
  const auto add = [&asked](const Solver* solver) {
    if (std::ranges::find(asked, solver) == asked.end()) asked.push_back(solver);
  };
  for (const std::string& id : call.texts("solver")) {
    if (id == "all") {
      for (const Solver* solver : all_solvers()) add(solver);
    } else if (const Solver* solver = find_solver(id)) {
      add(solver);
    } else {
      throw Error(Exit::usage, "--solver", "no solver \"" + id + "\"", "one of " + all_ids() + ", or all");
    }
  }
  return asked;
}

// "rank=4"
SolverValues values_asked(const cli::Invocation& call) {
  SolverValues values;
  for (const std::string& text : call.texts("set")) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error(Exit::usage, "--set", "\"" + text + "\" is no NAME=VALUE", "write --set rank=4");
    const std::string name = text.substr(0, equals);
    const double value = parse_quantity(text.substr(equals + 1), Dimension::none, "--set");
    if (!values.emplace(name, value).second) throw Error(Exit::usage, "--set", name + " is set twice");
  }
  return values;
}

bool has(const Solver& solver, const std::string& parameter) {
  return std::ranges::any_of(solver.info().parameters, [&](const SolverParameter& p) { return p.name == parameter; });
}

// Of several solvers each takes the values that it has; one alone refuses others.
SolverOptions options_for(const Solver& solver, const cli::Invocation& call, bool alone) {
  SolverOptions options;
  for (const auto& [name, value] : values_asked(call))
    if (alone || has(solver, name)) options.values[name] = value;
  options.most_iterations = static_cast<int>(call.integer("iterations"));
  options.seed = call.seed;
  return options;
}

// Whether the solver's model leaves such a sequence out.
bool cannot_take(const Solver& solver, const Sequence& sequence) {
  const SolverInfo& info = solver.info();
  const bool pinhole = sequence.projection == Projection::perspective && sequence.pinhole;
  return (!info.takes_missing && !sequence.complete()) || (!info.orthographic && !pinhole);
}

struct Job {
  const Solver* solver = nullptr;
  const Sequence* sequence = nullptr;
  SolverOptions options;
  fs::path file;
  std::optional<Solution> solution;
  std::optional<Error> refusal;

  std::string id() const { return sequence->name + "-" + solver->info().id; }
};

void finish(Job& job, bool resume, bool force) {
  const std::string identity = identity_of(*job.solver, *job.sequence, job.options);
  const bool there = fs::exists(job.file);
  if (there && resume) job.solution = read_solution(job.file, identity);
  if (job.solution) return;
  if (there && !force)
    throw Error(Exit::cannot_create, job.file.string(), "is not the answer that this call makes",
                "--force replaces it");
  try {
    job.solution = solve(*job.solver, *job.sequence, job.options);
    write_solution(*job.solution, identity, job.file);
  } catch (const Error& error) {
    if (error.code() != Exit::data) throw;
    job.refusal = error;
  }
}

std::vector<Sequence> sequences_asked(cli::Invocation& call) {
  std::vector<Sequence> sequences;
  std::vector<std::string> wanted = call.texts("sequence");
  if (wanted.empty())
    for (const auto& [id, entry] : call.document.sequences) wanted.push_back(id);
  std::set<std::string> known;
  for (const std::string& id : wanted) {
    if (!known.insert(id).second) continue;
    sequences.push_back(sequence_of(call.document, id));
    const std::string& file = call.document.sequences.at(id).file;
    call.note_input(manifest::resolve(call.document, file, "/sequences/" + id + "/file"));
  }
  for (const std::string& file : call.texts("TRACKS")) {
    call.note_input(file);
    Sequence sequence = read_sequence(file);
    sequence.name = enter_sequence(call.document, file, sequence);
    sequences.push_back(std::move(sequence));
  }
  return sequences;
}

std::vector<Job> jobs_of(const cli::Invocation& call, const std::vector<Sequence>& sequences) {
  const std::vector<const Solver*> solvers = solvers_asked(call);
  std::vector<Job> jobs;
  for (const Sequence& sequence : sequences) {
    for (const Solver* solver : solvers) {
      Job job{solver, &sequence, options_for(*solver, call, solvers.size() == 1), {}, {}, {}};
      if (sequence.name.find('/') != std::string::npos)
        throw Error(Exit::data, sequence.name, "cannot name a file", "rename the sequence");
      if (!cannot_take(*solver, sequence)) job.file = call.output_path(job.id() + ".mat");
      jobs.push_back(std::move(job));
    }
  }
  return jobs;
}

void work_on(std::vector<Job>& jobs, bool resume, bool force) {
  Progress progress("solving", jobs.size());
  try {
    parallel_for(0, jobs.size(), [&](std::size_t i) {
      finish(jobs[i], resume, force);
      progress.advance();
    });
  } catch (const Error& error) {
    if (error.code() != Exit::try_again) throw;
    const auto done = std::ranges::count_if(jobs, [](const Job& job) { return job.solution.has_value(); });
    throw Error(Exit::try_again, "",
                "interrupted by a signal, with " + std::to_string(done) + " of " + std::to_string(jobs.size()) +
                    " answers written",
                "--resume makes the rest");
  }
}

// What a sequence's notes say about a solver; what an earlier call said gives way.
void note(manifest::Document& document, const Job& job) {
  std::vector<std::string>& notes = document.sequences.at(job.sequence->name).notes;
  const std::string head = job.solver->info().id + ": ";
  std::erase_if(notes, [&head](const std::string& line) { return line.starts_with(head); });
  if (!job.refusal) return;
  const std::string& problem = job.refusal->problem();
  notes.push_back(problem.starts_with(head) ? problem : head + problem);
}

// Enters what has been solved; whether all solvers that could take their sequence have answered.
bool entered(cli::Invocation& call, const std::vector<Job>& jobs) {
  const std::vector<std::string>& asked = call.texts("solver");
  bool all = true;
  for (const Job& job : jobs) {
    note(call.document, job);
    if (job.solution) {
      enter_reconstruction(call.document, job.id(), job.sequence->name, *job.solution, call.seed, job.file);
      continue;
    }
    const bool failed = !job.file.empty();
    const bool by_name = std::ranges::find(asked, job.solver->info().id) != asked.end();
    log(failed || by_name ? LogLevel::warning : LogLevel::debug, job.refusal->what());
    all = all && !failed;
  }
  return all;
}

}  // namespace

std::vector<cli::Option> options() {
  return {{.name = "solver",
           .type = Type::text,
           .help = "Solver, or \"all\"; may be repeated.",
           .metavar = "NAME",
           .repeat = true},
          {.name = "set",
           .type = Type::text,
           .help = "Parameter of the solvers: rank=4. Of several solvers it goes to those that have it.",
           .metavar = "NAME=VALUE",
           .repeat = true},
          {.name = "sequence",
           .type = Type::text,
           .help = "Solve this sequence of the manifest; may be repeated. Default: all of them.",
           .metavar = "NAME",
           .repeat = true},
          {.name = "iterations",
           .type = Type::integer,
           .help = "The most iterations of an iterative solver; 0: its own limit.",
           .preset = "0",
           .lower = 0,
           .upper = 1e6},
          {.name = "list", .type = Type::flag, .help = "Print the solvers with their sources and parameters."}};
}

void check(cli::Invocation& call) {
  if (call.flag("list")) return;
  const std::vector<const Solver*> solvers = solvers_asked(call);
  if (solvers.empty()) throw Error(Exit::usage, "--solver", "is missing", "name one, or all; --list says which");
  for (const auto& [name, value] : values_asked(call))
    if (std::ranges::none_of(solvers, [&](const Solver* solver) { return has(*solver, name); }))
      values_in_force(solvers.front()->info(), {{name, value}});
  for (const Solver* solver : solvers)
    values_in_force(solver->info(), options_for(*solver, call, solvers.size() == 1).values);
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name a folder for the reconstructions");
  if (call.texts("TRACKS").empty() && call.document.sequences.empty())
    throw Error(Exit::usage, call.has_document ? manifest::place(call.document, "/sequences") : "TRACKS",
                "there is nothing to solve", "give files, or a manifest with sequences");
  for (const std::string& id : call.texts("sequence"))
    if (!call.document.sequences.contains(id))
      throw Error(Exit::usage, "--sequence", "the manifest has no \"" + id + "\"");
}

Exit run(cli::Invocation& call) {
  if (call.flag("list")) {
    std::cout << list_of_solvers() << std::flush;
    call.writes_document = false;
    return Exit::done;
  }
  const std::vector<Sequence> sequences = sequences_asked(call);
  std::vector<Job> jobs = jobs_of(call, sequences);
  work_on(jobs, call.resume, call.force);
  if (std::ranges::none_of(jobs, [](const Job& job) { return job.solution.has_value(); })) throw *jobs.front().refusal;
  return entered(call, jobs) ? Exit::done : Exit::quality;
}

}  // namespace gonio::tools::nrsfm_solve
