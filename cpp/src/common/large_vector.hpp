#pragma once

#include <sys/mman.h>

#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace pdoik::detail {

/// Memory that is not written before it is used, in large pages where there is much of it: the
/// system takes longer to hand out a million points' memory page by page than it takes to sort
/// them.
template <class T>
struct LargeAllocator {
  using value_type = T;
  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes < kLargePage) return static_cast<T*>(::operator new(bytes, kAlignment));
    const std::size_t whole = (bytes + kLargePage - 1) / kLargePage * kLargePage;
    void* const memory = std::aligned_alloc(kLargePage, whole);
    if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    static_cast<void>(madvise(memory, whole, MADV_HUGEPAGE));  // a hint: it may be refused
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    if (count * sizeof(T) < kLargePage)
      ::operator delete(memory, kAlignment);
    else
      std::free(memory);
  }
  /// What `resize` adds is left as it is.
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Values>
  void construct(U* at, Values&&... values) {
    ::new (static_cast<void*>(at)) U(std::forward<Values>(values)...);
  }
  bool operator==(const LargeAllocator&) const { return true; }

 private:
  static constexpr std::size_t kLargePage = std::size_t{1} << 21U;
  static constexpr std::align_val_t kAlignment{64};
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace pdoik::detail
