// nrsfm-eval's own options, checks and work in a folder of files, without the program.
#pragma once
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "data.h"
#include "nrsfm/files.h"
#include "shapes.h"
#include "tools/nrsfm-eval/call.h"

namespace gonio::nrsfm::tests {

struct Said {
  int status = 0;
  std::string error;
};

class EvalFolder : public testing::Test {
 protected:
  Said run(std::vector<std::string> arguments) {
    cli::Program program;
    program.name = "nrsfm-eval";
    program.sentence = "evaluate";
    program.options = gonio::tools::nrsfm_eval::options();
    program.operands = {{.name = "RECONSTRUCTION", .type = cli::Type::input_file, .help = "shapes", .repeat = true}};
    program.standalone = {"truth", "table"};
    program.takes_out = program.takes_seed = true;
    program.check = gonio::tools::nrsfm_eval::check;
    program.run = gonio::tools::nrsfm_eval::run;
    arguments.insert(arguments.begin(), "nrsfm-eval");
    arguments.insert(arguments.end(), {"-o", path("out.json")});
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    testing::internal::CaptureStderr();
    const int status = cli::main(program, static_cast<int>(argv.size()), argv.data());
    return {status, testing::internal::GetCapturedStderr()};
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const Shapes& shapes, const std::string& name, const std::string& algorithm = "pta") {
    Reconstruction r;
    r.name = algorithm;
    r.shapes = shapes;
    write_reconstruction(r, path(name + ".mat"));
  }
  void write_truth(const Shapes& shapes, const std::string& name, const Factors& factors) {
    Sequence s;
    s.truth = shapes;
    s.tracks = Eigen::MatrixXd::Random(shapes.rows() / 3 * 2, shapes.cols());
    s.visible = Visible::Constant(shapes.rows() / 3, shapes.cols(), true);
    s.unit_m = 0.001;
    s.factors = factors;
    write_sequence(s, path(name + ".mat"));
  }
  gonio::tests::ScratchFolder folder_;
};

}  // namespace gonio::nrsfm::tests
