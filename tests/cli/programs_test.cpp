// What every program promises, whichever programs there are: help, description, completions and man page that agree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/atomic_file.h"
#include "cli/common_options.h"
#include "cli/program.h"
#include "cli/reference.h"
#include "cli/roff.h"
#include "data.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

std::vector<cli::Option> all_options(const cli::Program& program) {
  std::vector<cli::Option> all = program.options;
  for (const auto& o : cli::common_options(program)) all.push_back(o);
  return all;
}

TEST(Programs, AreThere) {
  std::set<std::string> names;
  for (const auto* program : cli::all_programs()) names.insert(program->name);
  EXPECT_THAT(names, testing::IsSupersetOf({"calib-charuco", "camera-export", "compare", "develop", "explain",
                                            "handeye", "render", "scene", "vdi2634"}));
}

TEST(Programs, DescriptionsAreComplete) {
  for (const auto* program : cli::all_programs()) {
    SCOPED_TRACE(program->name);
    EXPECT_FALSE(program->sentence.empty() || program->synopsis.empty());
    EXPECT_TRUE(program->run);
    std::set<std::string> seen;
    for (const auto& o : all_options(*program)) {
      EXPECT_TRUE(seen.insert(o.name).second) << o.name << " stands twice";
      EXPECT_TRUE(o.help.ends_with('.')) << o.name << ": " << o.help;
      EXPECT_EQ(o.type == cli::Type::choice, !o.choices.empty()) << o.name;
    }
    for (const auto& o : all_options(*program))
      for (const auto& other : o.conflicts) EXPECT_TRUE(seen.contains(other)) << o.name << " conflicts with " << other;
    for (const auto& o : program->standalone) EXPECT_TRUE(seen.contains(o)) << o;
  }
}

// What one program asks before it replaces a file, all ask: whoever writes files has a folder for them, --out, and
// refuses to replace what lies there without --force.
TEST(Programs, WhoeverWritesFilesTakesOutAndForce) {
  for (const auto* program : cli::all_programs()) {
    const bool writes = !program->files.empty() || std::ranges::any_of(program->options, [](const cli::Option& o) {
      return o.type == cli::Type::output_file;
    });
    if (!writes) continue;
    std::set<std::string> names;
    for (const auto& o : all_options(*program)) names.insert(o.name);
    EXPECT_THAT(names, testing::IsSupersetOf({"out", "force"})) << program->name;
    EXPECT_FALSE(program->files.empty()) << program->name << " does not say what it writes below --out";
  }
}

// A former name is understood like the present one, and no help or page has it.
TEST(Programs, FormerNamesOfOptionsAreUnderstood) {
  std::size_t count = 0;
  for (const auto* program : cli::all_programs())
    for (const auto& o : program->options)
      for (const auto& alias : o.aliases) {
        ++count;
        SCOPED_TRACE(program->name + " --" + alias);
        EXPECT_THAT(run({program->name, "--help"}).out, testing::Not(HasSubstr("--" + alias)));
        // The complaint names the option by its present name: the value has reached it.
        EXPECT_THAT(run({program->name, "--" + alias, "bad"}).err, HasSubstr("--" + o.name));
        EXPECT_THAT(run({program->name, "--" + alias + "=bad"}).err, HasSubstr("--" + o.name));
      }
  EXPECT_GE(count, 2U);
}

TEST(Programs, HelpVersionAndDescriptionGoToStandardOutput) {
  for (const auto* program : cli::all_programs()) {
    SCOPED_TRACE(program->name);
    const Ended help = run({program->name, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(help.err, "");
    for (const auto& o : all_options(*program)) EXPECT_THAT(help.out, HasSubstr("--" + o.name));
    EXPECT_THAT(run({program->name, "--version"}).out, HasSubstr(program->name + " (gonio) "));
    const Ended described = run({program->name, "--describe"});
    const manifest::Value v = manifest::parse_json(described.out, "description");
    EXPECT_EQ(v.find("name")->as_string(), program->name);
    EXPECT_EQ(v.find("options")->as_array().size(), program->options.size());
  }
}

TEST(Programs, RefuseWhatNobodyKnows) {
  for (const auto* program : cli::all_programs()) {
    SCOPED_TRACE(program->name);
    const Ended unknown = run({program->name, "--treads", "3"});
    EXPECT_EQ(unknown.status, 64);
    EXPECT_THAT(unknown.err, HasSubstr("did you mean --threads?"));
    EXPECT_EQ(std::ranges::count(unknown.err, '\n'), 1);
    EXPECT_EQ(run({program->name, "--threads", "many"}).status, 64);
    EXPECT_EQ(run({program->name, "--threads", "-1"}).status, 64);
    EXPECT_EQ(run({program->name, "--progress", "sometimes"}).status, 64);
    if (program->reads == cli::Reads::none) continue;
    std::vector<std::string> call{program->name};
    for (const cli::Option& operand : program->operands)
      if (operand.required && operand.type == cli::Type::choice) call.push_back(operand.choices.front());
    call.insert(call.end(), {"-i", "no-such-manifest.json"});
    const Ended missing = run(call);
    EXPECT_EQ(missing.status, 66) << missing.err;
  }
}

TEST(Programs, ManPagesAreAsPrinted) {
  for (const auto* program : cli::all_programs()) {
    SCOPED_TRACE(program->name);
    const std::filesystem::path root = GONIO_SOURCE;
    const std::string prose = read_file(root / "man" / "prose" / (program->name + ".md"));
    EXPECT_FALSE(cli::section_of(prose, "DESCRIPTION").empty());
    EXPECT_FALSE(cli::section_of(prose, "EXAMPLES").empty());
    EXPECT_EQ(read_file(root / "man" / (program->name + ".1")), cli::man_page(*program, prose))
        << "run scripts/regenerate";
  }
}

TEST(Programs, CompletionsAreAcceptedByTheirShells) {
  ScratchFolder folder;
  for (const auto* program : cli::all_programs()) {
    SCOPED_TRACE(program->name);
    write_file(folder / "c.bash", cli::bash_completion(*program));
    write_file(folder / "c.zsh", cli::zsh_completion(*program));
    write_file(folder / "c.fish", cli::fish_completion(*program));
    EXPECT_EQ(run({"bash", "-n", "c.bash"}, folder.path()).status, 0);
    const int zsh = run({"zsh", "-n", "c.zsh"}, folder.path()).status;
    EXPECT_TRUE(zsh == 0 || zsh == 127) << zsh;  // 127: not installed
    const int fish = run({"fish", "-n", "c.fish"}, folder.path()).status;
    EXPECT_TRUE(fish == 0 || fish == 127) << fish;
  }
}

// The blocks between ``` under "# EXAMPLES" of man/prose, each as one shell script in a folder of its own.
std::vector<std::string> examples_of(const std::string& prose) {
  std::vector<std::string> blocks;
  const std::string text = cli::section_of(prose, "EXAMPLES");
  for (std::size_t at = text.find("```"); at != std::string::npos;) {
    const std::size_t first = text.find('\n', at) + 1, last = text.find("```", first);
    blocks.push_back(text.substr(first, last - first));
    at = text.find("```", last + 3);
  }
  return blocks;
}

std::vector<std::string> examples_of_page(const std::string& program) {
  return examples_of(read_file(std::filesystem::path(GONIO_SOURCE) / "man" / "prose" / (program + ".md")));
}

// Pages that begin with the same command, and what they begin with: whole lines that all of them have. It runs once,
// and each page goes on in a copy of the folder that it left. Four pages photograph the built-in board, a quarter of a
// minute.
struct Pages {
  std::vector<std::string> programs;
  std::string beginning;
};
std::vector<Pages> pages_by_beginning() {
  std::map<std::string, Pages> by_line;
  for (const auto* program : cli::all_programs()) {
    const auto blocks = examples_of_page(program->name);
    const std::string block = blocks.empty() ? program->name : blocks[0], line = block.substr(0, block.find('\n') + 1);
    Pages& pages = by_line[line];
    if (pages.programs.empty()) pages.beginning = block;
    const auto parted = std::ranges::mismatch(pages.beginning, block).in1 - pages.beginning.begin();
    pages.beginning.resize(pages.beginning.substr(0, static_cast<std::size_t>(parted)).rfind('\n') + 1);
    pages.programs.push_back(program->name);
  }
  std::vector<Pages> all;
  for (auto& [line, pages] : by_line) {
    // Not in the middle of a command that goes on.
    if (pages.programs.size() == 1 || pages.beginning.find_first_of("|\\{") != std::string::npos) pages.beginning = "";
    all.push_back(pages);
  }
  return all;
}

void PrintTo(const Pages& pages, std::ostream* out) {
  *out << testing::PrintToString(pages.programs);
}

class Examples : public testing::TestWithParam<Pages> {};
std::string as_identifier(const testing::TestParamInfo<Pages>& pages) {
  std::string name;
  for (const std::string& program : pages.param.programs) name += (name.empty() ? "" : "_") + program;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

TEST_P(Examples, OfTheManPageRun) {
  const auto& [programs, beginning] = GetParam();
  const ScratchFolder scratch;
  const auto shell = [&](const std::string& block, const std::filesystem::path& folder) {
    const Ended ended = run(
        {"bash", "-euc", std::string("PATH=") + GONIO_BIN + ":$PATH\nSOURCES=" + GONIO_SOURCE + "\n" + block}, folder);
    EXPECT_EQ(ended.status, 0) << block << ended.err;
  };
  const auto begun = scratch / "begun";
  std::filesystem::create_directory(begun);
  shell(beginning, begun);
  for (const std::string& program : programs) {
    SCOPED_TRACE(program);
    const auto folder = scratch / program;  // the examples of one page build on each other
    std::filesystem::copy(begun, folder, std::filesystem::copy_options::recursive);
    auto blocks = examples_of_page(program);
    ASSERT_FALSE(blocks.empty());
    ASSERT_TRUE(blocks[0].starts_with(beginning));
    blocks[0].erase(0, beginning.size());
    for (const auto& block : blocks) shell(block, folder);
  }
}
INSTANTIATE_TEST_SUITE_P(Programs, Examples, testing::ValuesIn(pages_by_beginning()), as_identifier);

}  // namespace
}  // namespace gonio::tests
