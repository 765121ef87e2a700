#include "numeric/parallel.hpp"

#include <algorithm>
#include <thread>

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "numeric/interruption.hpp"
#include "numeric/loop_order.hpp"

namespace fringe::detail {

void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task) {
  if (threads == 1 || count <= 1) {
    for (std::size_t k = 0; k < count; ++k) {
      check_interruption();
      task(k);
    }
    return;
  }
  const int offered = tbb::info::default_concurrency();
  tbb::task_arena arena(threads == 0 ? offered : std::min(static_cast<int>(threads), offered));
  const std::thread::id caller = std::this_thread::get_id();
  const LoopOrder order;
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      order.part_begins();
      if (std::this_thread::get_id() == caller)
        check_interruption();
      task(k);
      order.part_ends();
    });
  });
  order.loop_ended();
}

}  // namespace fringe::detail
