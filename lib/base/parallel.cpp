// Parallel loops on oneTBB. Every loop runs in one arena whose size set_threads() fixes.
//
// The exception that leaves a loop is that of the lowest failing index, so that an error message, too, is the same
// whatever the number of threads: once index i has failed, indices above i are skipped and those below still run.
#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>

#include "base/atomic_file.h"
#include "base/fault.h"

namespace gonio {
namespace {

struct Pool {
  explicit Pool(int count)
      : size(count > 0 ? count : tbb::info::default_concurrency()),
        limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(size)),
        arena(size) {}
  int size;
  tbb::global_control limit;
  tbb::task_arena arena;
};

std::mutex pool_mutex;

// Never destroyed: worker threads may outlive the destructors of other statics.
std::unique_ptr<Pool>& pool_slot() {
  static auto* slot = new std::unique_ptr<Pool>;
  return *slot;
}

Pool& pool() {
  const std::lock_guard lock(pool_mutex);
  auto& slot = pool_slot();
  if (!slot) slot = std::make_unique<Pool>(0);
  return *slot;
}

class LowestFailure {
 public:
  bool precedes(std::size_t index) const { return index_.load(std::memory_order_relaxed) < index; }
  void record(std::size_t index) {
    const std::lock_guard lock(mutex_);
    if (index >= index_.load()) return;
    index_ = index;
    exception_ = std::current_exception();
  }
  void rethrow() const {
    if (exception_) std::rethrow_exception(exception_);
  }

 private:
  std::atomic<std::size_t> index_{std::numeric_limits<std::size_t>::max()};
  std::mutex mutex_;
  std::exception_ptr exception_;
};

void run_chunk(std::size_t first, std::size_t last, const std::function<void(std::size_t)>& body,
               LowestFailure& failure) {
  guard_stack_of_this_thread();
  for (std::size_t i = first; i < last && !failure.precedes(i); ++i) {
    try {
      if (i == first) throw_if_interrupted();
      body(i);
    } catch (...) {
      failure.record(i);
    }
  }
}

}  // namespace

void set_threads(int count) {
  const std::lock_guard lock(pool_mutex);
  pool_slot() = std::make_unique<Pool>(count);
}

int threads() {
  return pool().size;
}

void parallel_for(std::size_t first, std::size_t last, const std::function<void(std::size_t)>& body,
                  std::size_t grain) {
  if (first >= last) return;
  const std::size_t chunk = grain > 0 ? grain : 1;
  const std::size_t chunks = (last - first - 1) / chunk + 1;
  LowestFailure failure;
  const auto run = [&](std::size_t c) {
    const std::size_t begin = first + c * chunk;
    run_chunk(begin, last - begin > chunk ? begin + chunk : last, body, failure);
  };
  // Isolation keeps a thread that waits for an inner loop from starting an iteration of an outer one on top of it.
  pool().arena.execute([&] {
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, chunks, run, tbb::simple_partitioner()); });
  });
  failure.rethrow();
}

}  // namespace gonio
