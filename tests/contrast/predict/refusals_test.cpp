// What `contrast predict` says of input that cannot be: one line that names the place, the value and the remedy.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cli/program.h"
#include "data.h"
#include "manifest/sections/contrast.h"
#include "samples.h"
#include "tools/contrast/predict.h"

namespace gonio::tests {
namespace {

struct Said {
  int status = 0;
  std::string error;
};

// The program's own options, checks and work, without the program.
Said predict_with(std::vector<std::string> arguments, const std::string& manifest = "") {
  cli::Program program;
  program.name = "contrast";
  program.sentence = "predict";
  program.options = tools::contrast::predict_options();
  program.options.push_back({.name = "html", .type = cli::Type::output_file, .help = "page"});
  program.takes_out = program.takes_seed = true;
  program.check = tools::contrast::check_predict;
  program.run = tools::contrast::run_predict;
  const tests::ScratchFolder scratch;
  const std::string folder = scratch.path();
  if (!manifest.empty()) {
    std::ofstream(folder + "/m.json") << manifest;
    arguments.insert(arguments.end(), {"-i", folder + "/m.json"});
  }
  arguments.insert(arguments.end(), {"-o", folder + "/out.json"});
  arguments.insert(arguments.begin(), "contrast");
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  testing::internal::CaptureStderr();
  const int status = cli::main(program, static_cast<int>(argv.size()), argv.data());
  return {status, testing::internal::GetCapturedStderr()};
}

struct Wrong {
  std::vector<std::string> arguments;
  std::string manifest;
  int status;
  std::string says;
};

TEST(ContrastRefusals, OneLineWithPlaceValueAndRemedy) {
  const std::string two = R"({"gonio": 1, "surfaces": {"a": {"model": "diffuse", "albedo": 0.5},)"
                          R"( "b": {"model": "diffuse", "albedo": 0.5}}})";
  const std::vector<Wrong> wrong{
      {{"--model", "rigded"}, "", 64, "choose one of"},
      {{"--tilts=-20deg,,0deg"}, "", 64, "empty place"},
      {{"--tilts=20"}, "", 64, "--tilts"},
      {{"--tilts=0.4m"}, "", 64, "--tilts"},
      {{"--tilts=95deg"}, "", 64, "below the horizon"},
      {{"--tilts=85deg", "--light-plane", "along"}, "", 64, "lamp below the horizon"},
      {{"--light-spread", "85deg"}, "", 64, "--light-spread"},
      {{"--pairs", "90deg"}, "", 64, "0deg:90deg"},
      {{"--pairs", "90deg:450deg"}, "", 64, "with itself"},
      {{"--set", "ridge_rad"}, "", 64, "NAME=VALUE"},
      {{"--set", "ridge_rad=5"}, "", 64, "ridge_rad"},
      {{"--set", "ridges=5deg"}, "", 64, "it takes ridge_rad"},
      {{"--set", "walls=2"}, "", 64, "--set walls: is 2, outside 0 to 1"},
      {{"--set", "alpha_u=0.05,0.1"}, "", 64, "give one here"},
      {{"--set", "walls=1", "--set", "walls=0"}, "", 64, "given twice"},
      {{"--model", "dielectric"}, "", 64, "lets light through"},
      {{"--model", "merl"}, "", 64, "needs a file"},
      {{"--vary", "alpha_u=0.1,2"}, "", 64, "is outside"},
      {{"--vary", "alpha_u=0.1", "--vary", "alpha_u=0.2"}, "", 64, "given twice"},
      {{"--model", "sinusoidal"}, "", 64, "needs amplitude_m"},
      {{"--sigma", "alpha_u=-0.1"}, "", 64, "negative"},
      {{"--surface", "s"}, "", 66, "name the manifest"},
      {{"--optimize", "--bound", "ridge_rad=20deg:5deg"}, "", 64, "lower end first"},
      {{"--optimize", "--bound", "pitch_m=200um:300um"}, "", 64, "seen one by one"},
      {{"--optimize", "--model", "diffuse", "--set", "albedo=0.5", "--bound", "pitch_m=20um:50um"},
       "",
       64,
       "length of ridges"},
      {{"--optimize", "--model", "diffuse", "--set", "albedo=0.5"}, "", 64, "--bound"},
      {{"--optimize", "--model", "diffuse", "--set", "albedo=0.5", "--bound", "albedo=0.1:0.9"}, "", 65, "no contrast"},
      {{"--optimize", "--vary", "alpha_u=0.1"}, "", 64, "--vary"},
      {{"--bound", "alpha_u=0.1:0.2"}, "", 64, "--optimize"},
      {{"--model", "diffuse"}, two, 64, "manifest"},
      {{}, two, 64, "--surface a"},
      {{"--surface", "c"}, two, 65, "has no surface \"c\""},
      {{}, R"({"gonio": 1})", 65, "has no surface"},
      {{}, R"({"gonio": 1, "surfaces": {"g": {"model": "dielectric", "eta": 1.5}}})", 65, "lets light through"},
      {{},
       R"({"gonio": 1, "surfaces": {"s": {"model": "diffuse", "albedo": 0.5, "sigma": {"colour": 0.1}}}})",
       65,
       "it takes albedo"},
  };
  for (const Wrong& w : wrong) {
    const Said said = predict_with(w.arguments, w.manifest);
    const std::string what = w.arguments.empty() ? w.manifest : w.arguments.back();
    EXPECT_EQ(said.status, w.status) << what << ": " << said.error;
    EXPECT_NE(said.error.find(w.says), std::string::npos) << what << ": " << said.error;
    EXPECT_EQ(std::count(said.error.begin(), said.error.end(), '\n'), 1) << said.error;
  }
}

TEST(ContrastRefusals, WhatIsRightPasses) {
  EXPECT_EQ(predict_with({}).status, 0);
  const Said said = predict_with({"--vary", "albedo=0.2,0.4"},
                                 R"({"gonio": 1, "surfaces": {"s": {"model": "diffuse", "albedo": 0.5}}})");
  EXPECT_EQ(said.status, 0) << said.error;
}

// What is written holds what was predicted, and a second call replaces it.
TEST(ContrastRefusals, EntriesAreSignedAndReplaced) {
  const contrast::Prediction p = contrast::predict(ridged(0.05, 0.05), {});
  const auto entries = contrast::entries_of(p);
  ASSERT_EQ(entries.size(), p.combinations.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EXPECT_NEAR(*entries[i].difference, entries[i].signals[0] - entries[i].signals[1], 1e-15);
    EXPECT_EQ(entries[i].surface, "s");
  }
}

}  // namespace
}  // namespace gonio::tests
