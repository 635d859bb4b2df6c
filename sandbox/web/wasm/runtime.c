/* What Numba's compiled code asks of a runtime: memory, reference counts, and the shape of a view.
 *
 * Memory lasts as long as it is held, or until `forget` is called, before each increment: whatever has happened, nothing piles up.
 * What `reserve` hands out lasts for good. Blocks are powers of two with lists of free ones, each behind a head of 64 bytes.
 */
typedef long long i64;
typedef unsigned long address;

typedef struct {
  i64 count;
  void *destructor, *about, *data;
  i64 size;
} Held;

enum { HEAD = 64, CLASSES = 32, PAGE = 65536 };
extern char __heap_base;
static address bottom, top;
static Held *free_blocks[CLASSES];

static address take(i64 bytes) {
  if (!top) bottom = top = ((address)&__heap_base + HEAD - 1) & ~(address)(HEAD - 1);
  address start = top;
  i64 end = (i64)start + ((bytes + HEAD - 1) & ~(i64)(HEAD - 1));
  i64 missing = end - (i64)__builtin_wasm_memory_size(0) * PAGE;
  if (bytes < 0 || end > 0x7fffffff) __builtin_trap();
  if (missing > 0 && __builtin_wasm_memory_grow(0, (address)((missing + PAGE - 1) / PAGE)) == (address)-1) __builtin_trap();
  top = (address)end;
  return start;
}

__attribute__((export_name("forget"))) void forget(void) {
  for (int k = 0; k < CLASSES; k++) free_blocks[k] = 0;
  top = bottom;
}

__attribute__((export_name("reserve"))) void *reserve(i64 bytes) {
  forget();
  address start = take(bytes);
  bottom = top;
  return (void *)start;
}

void *NRT_MemInfo_alloc_safe_aligned(i64 size, int align) {
  (void)align;
  int class = 6;
  while (((i64)1 << class) < size + HEAD) class++;
  Held *held = class < CLASSES ? free_blocks[class] : 0;
  if (held) free_blocks[class] = (Held *)held->about;
  else held = (Held *)take((i64)1 << class);
  held->count = 1;
  held->size = class;
  held->data = (char *)held + HEAD;
  return held;
}

void *NRT_MemInfo_alloc_aligned(i64 size, int align) { return NRT_MemInfo_alloc_safe_aligned(size, align); }

void *NRT_MemInfo_alloc(i64 size) { return NRT_MemInfo_alloc_safe_aligned(size, HEAD); }

void *NRT_MemInfo_alloc_safe(i64 size) { return NRT_MemInfo_alloc_safe_aligned(size, HEAD); }

void NRT_incref(Held *held) {
  if (held) held->count++;
}

void NRT_decref(Held *held) {
  if (!held || --held->count) return;
  held->about = free_blocks[held->size];
  free_blocks[held->size] = held;
}

void *NRT_Allocate(i64 size) { return ((Held *)NRT_MemInfo_alloc_safe_aligned(size, HEAD))->data; }

void NRT_Free(void *data) {
  if (data) NRT_decref((Held *)((char *)data - HEAD));
}

/* All arrays whose shape is changed are whole and in order of rows. */
int numba_attempt_nocopy_reshape(i64 nd, const i64 *dims, const i64 *strides, i64 newnd, const i64 *newdims, i64 *newstrides,
                                 i64 itemsize, int is_f_order) {
  (void)nd, (void)dims, (void)strides, (void)is_f_order;
  i64 step = itemsize;
  for (i64 k = newnd - 1; k >= 0; k--) {
    newstrides[k] = step;
    step *= newdims[k];
  }
  return 1;
}
