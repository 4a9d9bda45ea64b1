// gonio-describe: prints everything that is printed from descriptions: man pages, JSON Schema, shell completions. Not
// installed; scripts/regenerate calls it:  gonio-describe SOURCE_ROOT  writes man/*.[157], schemas/ and completions/
// below SOURCE_ROOT.
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "cli/program.h"
#include "cli/reference.h"
#include "cli/roff.h"
#include "explain/domain_listing.h"
#include "manifest/reference.h"
#include "mechanism/listing.h"
#include "mechanism/reference.h"
#include "nrsfm/solve/listing.h"

namespace {

namespace fs = std::filesystem;
using namespace gonio;

std::string prose(const fs::path& root, const std::string& name) {
  return read_file(root / "man" / "prose" / (name + ".md"));
}

// A page whose prose stands alone; "# NAME" holds its one sentence. What is generated stands before SEE ALSO, and a
// page of many parts starts with its contents.
std::string page(const fs::path& root, const std::string& name, int section, const std::string& generated = {}) {
  const std::string text = prose(root, name);
  std::string sentence = cli::section_of(text, "NAME");
  while (!sentence.empty() && (sentence.back() == '\n' || sentence.back() == ' ')) sentence.pop_back();
  const auto first = text.find("\n# ");
  std::string all = text.substr(first == std::string::npos ? 0 : first + 1);
  all.insert(std::min(all.find("# SEE ALSO"), all.size()), generated);
  return cli::man_header(name, section, sentence) + cli::roff_from_markdown(cli::contents_of(all) + all);
}

void write_all(const fs::path& root) {
  for (const auto* program : cli::all_programs()) {
    write_file(root / "man" / (program->name + ".1"), cli::man_page(*program, prose(root, program->name)));
    write_file(root / "completions" / "bash" / program->name, cli::bash_completion(*program));
    write_file(root / "completions" / "zsh" / ("_" + program->name), cli::zsh_completion(*program));
    write_file(root / "completions" / "fish" / (program->name + ".fish"), cli::fish_completion(*program));
  }
  write_file(root / "man" / "gonio-manifest.5",
             page(root, "gonio-manifest", 5, "# SECTIONS\n" + manifest::manifest_fields_text()));
  write_file(root / "man" / "gonio-mechanisms.7",
             page(root, "gonio-mechanisms", 7, mechanism::markdown() + explain::product_markdown()));
  write_file(root / "man" / "gonio-nrsfm.7", page(root, "gonio-nrsfm", 7, nrsfm::markdown()));
  write_file(root / "man" / "gonio-surfaces.7", page(root, "gonio-surfaces", 7, manifest::surface_models_text()));
  for (const char* name : {"gonio", "gonio-conventions"})
    write_file(root / "man" / (std::string(name) + ".7"), page(root, name, 7));
  write_file(root / "schemas" / "manifest-1.schema.json",
             manifest::schema_text(manifest::manifest_schema(mechanism::uses_schema())));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw Error(Exit::usage, "gonio-describe", "takes one operand", "the root of the source tree");
    for (const char* folder : {"man", "schemas", "completions/bash", "completions/zsh", "completions/fish"})
      make_folder(fs::path(argv[1]) / folder);
    write_all(argv[1]);
  } catch (const Error& e) {
    std::cerr << "gonio-describe: " << e.what() << '\n';
    return static_cast<int>(e.code());
  }
  return 0;
}
