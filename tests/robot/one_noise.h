// The noise of one robot as handeye and explain state it, one after the other in a pipe: in words and in the manifest.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "manifest/document.h"
#include "manifest/sections/mounting.h"
#include "process.h"

namespace gonio::tests {

struct NoiseFigure {
  double robot_m = 0, robot_rad = 0;       // in the manifest
  double printed_mm = 0, printed_deg = 0;  // in words
};
struct BothNoises {
  NoiseFigure handeye, explain;
  std::vector<std::string> outliers;  // what handeye left out
  std::string sentence;               // explain's, of the robot
};

inline NoiseFigure noise_figure(const manifest::Mounting& mounting, const std::string& words, const char* pattern) {
  std::smatch found;
  if (!std::regex_search(words, found, std::regex(pattern))) throw std::runtime_error("no noise in: " + words);
  return {mounting.robot_m.value(), mounting.robot_rad.value(), std::stod(found[1]), std::stod(found[2])};
}

// `handeye`: what that program ended with, of a camera called "camera". Its manifest goes into explain.
inline BothNoises both_noises(const Ended& handeye) {
  const Ended explain = run({"explain", "--allow-outside"}, {}, handeye.out);
  EXPECT_TRUE(explain.status == 0 || explain.status == 1) << explain.err;
  const auto before = manifest::parse_document(handeye.out, "out", ".", {.allow_outside = true});
  const auto after = manifest::parse_document(explain.out, "out", ".", {.allow_outside = true});
  BothNoises b;
  for (const auto& e : after.explanations)
    if (e.find("domain")->as_string() == "robot") b.sentence = e.find("sentence")->as_string();
  const manifest::Mounting &first = before.mountings.at("camera"), &second = after.mountings.at("camera");
  b.outliers = first.outliers;
  b.handeye = noise_figure(first, handeye.err, R"(robot noise ([\d.e-]+) mm, ([\d.e-]+) deg per axis)");
  b.explain =
      noise_figure(second, b.sentence,
                   R"(noise of the robot's poses.*? is ([\d.]+) mm a coordinate and (?:less than )?([\d.]+) deg)");
  return b;
}

// To a share in the manifest; explain's words have two digits.
inline void expect_one_figure(const BothNoises& b, double share) {
  EXPECT_THAT(b.sentence, testing::HasSubstr("about the mountings as handeye states it"));
  EXPECT_NEAR(b.explain.robot_m, b.handeye.robot_m, share * b.handeye.robot_m) << b.sentence;
  EXPECT_NEAR(b.explain.robot_rad, b.handeye.robot_rad, share * b.handeye.robot_rad) << b.sentence;
  EXPECT_NEAR(b.explain.printed_mm, b.handeye.printed_mm, (share + 0.05) * b.handeye.printed_mm) << b.sentence;
  EXPECT_NEAR(b.explain.printed_deg, b.handeye.printed_deg, (share + 0.05) * b.handeye.printed_deg + 0.001)
      << b.sentence;
}

}  // namespace gonio::tests
