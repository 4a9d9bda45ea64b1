// One instrument, one lock. The lock is a name in the kernel (a Unix socket without a file), made of the URLs that
// reach the devices: whatever manifest and folder they stand in, two programs on one computer cannot drive the same
// robot at once, and a program that is killed leaves nothing behind. Programs on two computers are not kept apart.
#pragma once
#include <chrono>
#include <string>
#include <vector>

namespace gonio::acquisition {

class InstrumentLock {
 public:
  // One lock a URL, in alphabetical order, so that two programs cannot wait for each other. Error(try_again) where
  // another holds one for longer than `wait`; an interrupt ends the wait.
  InstrumentLock(std::vector<std::string> urls, std::chrono::duration<double> wait);
  ~InstrumentLock();
  InstrumentLock(const InstrumentLock&) = delete;
  InstrumentLock& operator=(const InstrumentLock&) = delete;

 private:
  std::vector<int> sockets_;
};

}  // namespace gonio::acquisition
