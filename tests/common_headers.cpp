#include "tests/common_headers.h"
