#pragma once

#include <functional>

namespace pdoik::detail {

/// Run `work` on this thread and, at the same time, on up to `helpers` threads of a pool that lasts
/// as long as the process. Returns when all have ended. May be called by several threads at once:
/// helpers that are busy elsewhere come later or not at all, so the work must not count on them.
/// @param work  Throws nothing.
/// @param while_waiting  Called ten times a second while this thread waits for helpers to end.
void run_together(int helpers, const std::function<void()>& work,
                  const std::function<void()>& while_waiting);

/// The number of this machine's processors, at least 1.
int processor_count();

}  // namespace pdoik::detail
