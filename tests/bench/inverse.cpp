// `scripts/bench inverse`: inverse kinematics of the known arms, of an arm with a factory calibration and of random
// geometry, beside the numeric solvers of KDL (package liborocos-kdl-dev) where it is installed: one thread, processor
// time, the same poses of random joints.
//   bench-inverse [POSES [CALIBRATION.conf]]
// Own: all branches. A pose counts as lost unless the joints that made it are among the answers, to 1e-5 rad. KDL: one
// answer from random starting joints, once (Levenberg-Marquardt; Newton-Raphson), reached within its own limit.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "base/random.h"
#include "robot/inverse/inverse_kinematics.h"
#include "robot/inverse_world.h"
#include "robot/ur_calibration.h"

#ifdef GONIO_HAS_KDL
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#endif

namespace gonio::robot {
namespace {

double now_s() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

using Pose = Rigid<frame::Base, frame::Tool>;
struct Poses {
  std::vector<Joints> joints;
  std::vector<Pose> poses;
};

Poses random_poses(std::span<const Link> links, int count, std::uint64_t seed) {
  Random random(seed, 3);
  Poses p;
  for (int i = 0; i < count; ++i) {
    p.joints.push_back(inverse_world::random_joints(random));
    p.poses.push_back(flange(links, p.joints.back()));
  }
  return p;
}

double own_us(const InverseKinematics& inverse, const Poses& poses) {
  std::size_t answers = 0;
  const double begun = now_s();
  for (const Pose& pose : poses.poses) answers += inverse.solve(pose).size();
  const double us = 1e6 * (now_s() - begun) / static_cast<double>(poses.poses.size());
  return answers > 0 ? us : -1;
}

void run_own(const std::string& name, std::span<const Link> links, const Poses& poses) {
  const InverseKinematics inverse(links);
  inverse_world::Tally tally;
  for (const Joints& joints : poses.joints) tally.take(inverse, links, joints);
  std::printf("%-18s own  %8.2f us a pose; %s\n", name.c_str(), own_us(inverse, poses), tally.words().c_str());
}

#ifdef GONIO_HAS_KDL
KDL::Chain chain_of(std::span<const Link> links) {
  KDL::Chain chain;
  for (const Link& l : links)
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(l.a_m, l.alpha_rad, l.d_m, l.theta_rad)));
  return chain;
}

KDL::Frame frame_of(const Pose& pose) {
  const Quaternion q = pose.rotation;
  const Vec3 t = pose.translation_m;
  return {KDL::Rotation::Quaternion(q.x, q.y, q.z, q.w), KDL::Vector(t.x, t.y, t.z)};
}

template <class Solver>
void run_peer(const char* name, Solver& solver, std::span<const Link> links, const Poses& poses) {
  Random random(71, 5);
  int reached = 0;
  double seconds = 0, worst_m = 0;
  for (const Pose& pose : poses.poses) {
    KDL::JntArray start(6), answer(6);
    for (unsigned i = 0; i < 6; ++i) start(i) = random.uniform(-pi, pi);
    const KDL::Frame wanted = frame_of(pose);
    const double begun = now_s();
    const int status = solver.CartToJnt(start, wanted, answer);
    seconds += now_s() - begun;
    if (status < 0) continue;
    ++reached;
    Joints joints;
    for (unsigned i = 0; i < 6; ++i) joints[i] = answer(i);
    worst_m = std::max(worst_m, inverse_world::miss_of(links, joints, pose).position_m);
  }
  const auto count = static_cast<double>(poses.poses.size());
  std::printf("%-18s %-4s %8.2f us a pose; one answer for %.1f %%, worst of them %.2g m\n", "", name,
              1e6 * seconds / count, 100 * reached / count, worst_m);
}

void run_peers(std::span<const Link> links, const Poses& all) {
  const std::size_t count = std::min<std::size_t>(all.poses.size(), 5000);  // they take their time
  Poses poses;
  poses.poses.assign(all.poses.begin(), all.poses.begin() + static_cast<std::ptrdiff_t>(count));
  const KDL::Chain chain = chain_of(links);
  KDL::ChainIkSolverPos_LMA lma(chain);
  run_peer("LMA", lma, links, poses);
  KDL::ChainFkSolverPos_recursive forward(chain);
  KDL::ChainIkSolverVel_pinv velocity(chain);
  KDL::ChainIkSolverPos_NR newton(chain, forward, velocity, 500, 1e-6);
  run_peer("NR", newton, links, poses);
}
#else
void run_peers(std::span<const Link>, const Poses&) {}
#endif

std::vector<Link> random_links(Random& random) {
  std::vector<Link> links;
  for (int i = 0; i < 6; ++i)
    links.push_back(
        {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-pi, pi), random.uniform(-pi, pi)});
  return links;
}

void run(int count, const char* calibration) {
  for (const Arm& arm : known_arms()) {
    const Poses poses = random_poses(arm.links, count, 17);
    run_own(arm.name, arm.links, poses);
    run_peers(arm.links, poses);
  }
  if (calibration != nullptr) {
    const Arm arm = calibrated(known_arm("ur10e", "bench"), read_ur_calibration(calibration), "bench");
    const Poses poses = random_poses(arm.links, count, 18);
    run_own("ur10e, calibrated", arm.links, poses);
    run_peers(arm.links, poses);
  }
  Random random(19, 1);
  const std::vector<Link> links = random_links(random);
  const Poses poses = random_poses(links, std::max(1, count / 10), 20);
  run_own("random geometry", links, poses);
  run_peers(links, poses);
}

}  // namespace
}  // namespace gonio::robot

int main(int argc, char** argv) {
  gonio::robot::run(argc > 1 ? std::atoi(argv[1]) : 20000, argc > 2 ? argv[2] : nullptr);
}
