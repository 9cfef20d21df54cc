// VAMP fetches pdqsort; Boost has the same by its author.
#pragma once

#include <boost/sort/pdqsort/pdqsort.hpp>

using boost::sort::pdqsort;
using boost::sort::pdqsort_branchless;
