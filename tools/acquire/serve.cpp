// acquire --serve: the simulated laboratory on loopback, until it is interrupted.
#include <chrono>
#include <memory>
#include <thread>

#include "acquisition/desk/served_laboratory.h"
#include "base/atomic_file.h"
#include "base/progress.h"
#include "base/text.h"
#include "tools/acquire/call.h"

namespace gonio::tools::acquire {
namespace {

using namespace gonio::acquisition;

Exit serve_until_interrupted(const ServedLaboratory& served, const ServeOptions& options) {
  for (const std::string& line : served.words()) log(LogLevel::info, line);
  log(LogLevel::info, "serving until interrupted");
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  for (const auto& [kind, probability] : options.faults)
    log(LogLevel::info, format("%s: %lld times", desk::fault_kinds.at(static_cast<std::size_t>(kind)).name,
                               static_cast<long long>(served.struck(kind))));
  return Exit::done;
}

}  // namespace

Exit serve(cli::Invocation& call) {
  ServeOptions options;
  options.desk.seed = call.seed;
  options.desk.spp = static_cast<int>(call.integer("spp"));
  options.pace = call.number("pace");
  options.port = static_cast<int>(call.integer("port"));
  if (call.given("faults")) options.faults = parse_faults(call.text("faults"), "--faults");
  const auto read = [&call](const char* option, manifest::Document& document) -> const manifest::Document* {
    if (!call.given(option)) return nullptr;
    call.note_input(call.text(option));
    document = manifest::read_document(call.text(option));
    return &document;
  };
  manifest::Document scene, truth;
  const auto served =
      std::make_shared<ServedLaboratory>(call.document, read("scene", scene), read("truth", truth), options);
  call.document = served->description();
  call.afterwards = [served, options] { return serve_until_interrupted(*served, options); };
  return Exit::done;
}

}  // namespace gonio::tools::acquire
