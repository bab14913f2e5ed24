(* Precedence: Lemmas 1 to 3 and 5 of docs/theorem.md, "By arrival" and "Counts of rest". *)
Require Import Reals Lra Lia Psatz.
Require Import Contract Shipped Motion Reach Statement Ego.
Open Scope R_scope.

(** * By arrival *)

(* What a shield knows of a vehicle's arrival on its own clock, which is [offset] ahead: after < arrival <= by. *)
Definition knows_arrival (offset arrival after by_ : R) := after < arrival + offset <= by_.

(* Lemma 1: with the right of way of one of them, not both claim by arrival. *)
Lemma arrivals_exclude (P Q o o' theta by_P after_P by_Q after_Q by_P' after_P' by_Q' after_Q' : R) :
  knows_arrival o P after_P by_P -> knows_arrival o Q after_Q by_Q ->
  knows_arrival o' P after_P' by_P' -> knows_arrival o' Q after_Q' by_Q' ->
  by_P <= after_Q + theta -> ~ by_Q' + theta <= after_P'.
Proof. unfold knows_arrival. lra. Qed.

(* The same without a right of way. *)
Lemma arrivals_exclude_equals (P Q o o' theta by_P after_P by_Q after_Q by_P' after_P' by_Q' after_Q' : R) :
  0 <= theta ->
  knows_arrival o P after_P by_P -> knows_arrival o Q after_Q by_Q ->
  knows_arrival o' P after_P' by_P' -> knows_arrival o' Q after_Q' by_Q' ->
  by_P + theta <= after_Q -> ~ by_Q' + theta <= after_P'.
Proof. unfold knows_arrival. lra. Qed.

(** * Counts of rest *)

Section Rest.
Variables (k : contract) (v : R -> R) (from r : R).
Hypothesis ok : valid k.
Hypothesis keeps : keeps_contract k v from.

(* D: the deepest dip between two calls brakes at b̂ and then accelerates at â. *)
Definition dip :=
  (period k + 2 * jitter k) * (other_acceleration k * other_braking k / (other_acceleration k + other_braking k)).

(* Lemma 2: a vehicle that is fast at two calls that follow each other is above r all the time between them. *)
Lemma moves_between t1 t t2 :
  from <= t1 -> t1 <= t <= t2 -> t2 - t1 <= period k + 2 * jitter k -> r + dip < v t1 -> r + dip < v t2 -> r < v t.
Proof.
  intros h [h1 h2] span v1 v2. destruct (Rlt_le_dec r (v t)) as [? | slow]; [assumption | exfalso].
  assert (a0 : 0 < other_acceleration k) by (destruct ok; lra).
  assert (b0 : 0 < other_braking k) by (destruct ok; lra).
  set (a := other_acceleration k) in *. set (b := other_braking k) in *.
  pose proof (brakes k v from keeps t t1 t ltac:(lra) ltac:(lra) ltac:(lra)) as down. fold b in down.
  pose proof (rushes k v from keeps t2 t t2 ltac:(lra) ltac:(lra) ltac:(lra)) as up. fold a in up.
  pose proof (Rmin_l (v t + a * (t2 - t)) (Rmax (other_max_speed k) (v t))).
  assert (D1 : dip < b * (t - t1)) by lra. assert (D2 : dip < a * (t2 - t)) by lra.
  assert (E : dip * (a + b) = (period k + 2 * jitter k) * (a * b)) by (unfold dip; fold a b; field; lra).
  assert (dip * a < b * (t - t1) * a) by (apply Rmult_lt_compat_r; lra).
  assert (dip * b < a * (t2 - t) * b) by (apply Rmult_lt_compat_r; lra).
  assert ((period k + 2 * jitter k) * (a * b) < (t2 - t1) * (a * b)) by lra.
  assert ((t2 - t1) * (a * b) <= (period k + 2 * jitter k) * (a * b)) by (apply Rmult_le_compat_r; nra).
  lra.
Qed.

(* A vehicle that is at rest, up to r, at two calls that follow each other creeps little between them: at worst it accelerates at
   â and then brakes at b̂. *)
Lemma creeps_between place t1 t2 :
  motion place v -> from <= t1 <= t2 -> t2 - t1 <= period k + 2 * jitter k -> v t1 <= r -> v t2 <= r ->
  place t2 - place t1 <= (t2 - t1) * (r + dip / 2).
Proof.
  intros m [lo le] span v1 v2.
  assert (a0 : 0 < other_acceleration k) by (destruct ok; lra).
  assert (b0 : 0 < other_braking k) by (destruct ok; lra).
  unfold dip. set (a := other_acceleration k) in *. set (b := other_braking k) in *. set (h := t2 - t1) in *.
  assert (h0 : 0 <= h) by (unfold h; lra).
  set (h1 := h * b / (a + b)). set (h2 := h * a / (a + b)).
  assert (sum : h1 + h2 = h) by (unfold h1, h2; field; lra).
  assert (h10 : 0 <= h1) by (unfold h1; apply Rmult_le_pos; [apply Rmult_le_pos; lra | left; apply Rinv_0_lt_compat; lra]).
  assert (h20 : 0 <= h2) by (unfold h2; apply Rmult_le_pos; [apply Rmult_le_pos; lra | left; apply Rinv_0_lt_compat; lra]).
  set (tm := t1 + h1). assert (tm2 : t2 - tm = h2) by (unfold tm, h in *; lra).
  pose proof (below_line place v r a t1 tm m ltac:(unfold tm; lra)) as A.
  specialize (A ltac:(intros u hu; pose proof (rushes k v from keeps u t1 u ltac:(lra) ltac:(lra) ltac:(lra)) as up; fold a in up;
    pose proof (Rmin_l (v t1 + a * (u - t1)) (Rmax (other_max_speed k) (v t1))); lra)).
  pose proof (below_line place v (r + b * h2) (- b) tm t2 m ltac:(lra)) as B.
  specialize (B ltac:(intros u hu; pose proof (brakes k v from keeps t2 u t2 ltac:(unfold tm in hu; lra) ltac:(lra) ltac:(lra)) as down;
    fold b in down; replace (r + b * h2 + - b * (u - tm)) with (r + b * (t2 - u)) by (rewrite <- tm2; ring); lra)).
  rewrite tm2 in B. replace (tm - t1) with h1 in A by (unfold tm; ring).
  assert (E : a * h1 * h1 / 2 + b * h2 * h2 / 2 = h * h / 2 * (a * b / (a + b))) by (unfold h1, h2; field; lra).
  assert (W : h * h / 2 * (a * b / (a + b)) <= h * ((period k + 2 * jitter k) * (a * b / (a + b)) / 2)).
  { assert (c0 : 0 <= a * b / (a + b)) by (apply Rmult_le_pos; [apply Rmult_le_pos; lra | left; apply Rinv_0_lt_compat; lra]).
    assert (h * h * (a * b / (a + b)) <= h * (period k + 2 * jitter k) * (a * b / (a + b))); [| lra].
    apply Rmult_le_compat_r; [exact c0 |]. apply Rmult_le_compat_l; lra. }
  replace (h * (r + (period k + 2 * jitter k) * (a * b / (a + b)) / 2))
    with (r * (h1 + h2) + h * ((period k + 2 * jitter k) * (a * b / (a + b)) / 2)) by (rewrite sum; ring).
  lra.
Qed.

(* Two shields, each on its grid. *)
Variables (p q : nat -> R).
Hypothesis grid_p : on_grid k p.
Hypothesis grid_q : on_grid k q.

(* So many calls in a row that show motion end a count: 2 without jitter, 3 with it. *)
Definition enough (m : nat) := (m = 2%nat /\ jitter k = 0) \/ (m = 3%nat /\ jitter k <= period k / 8).

Lemma enough_time m i : enough m -> p i + period k + 2 * jitter k <= p (i + (m - 1))%nat.
Proof.
  intros en. pose proof (spacing k p grid_p i (m - 1)) as [L _].
  assert (0 < period k) by (destruct ok; lra). assert (0 <= jitter k) by (destruct ok; lra).
  destruct en as [[-> j0] | [-> j8]]; cbn [Nat.sub INR] in *; lra.
Qed.

(* The same for several calls. *)
Lemma creeps_throughout place i n :
  motion place v -> from <= p i -> (forall j, (i <= j <= i + n)%nat -> v (p j) <= r) ->
  place (p (i + n)%nat) - place (p i) <= (p (i + n)%nat - p i) * (r + dip / 2).
Proof.
  intros m lo slow. induction n as [| n IH].
  - rewrite Nat.add_0_r. lra.
  - specialize (IH ltac:(intros; apply slow; lia)).
    pose proof (calls_ordered k p ok grid_p i (i + n) ltac:(lia)). pose proof (calls_ordered k p ok grid_p (i + n) (i + S n) ltac:(lia)).
    pose proof (spacing k p grid_p (i + n) 1) as [_ far]. replace (i + n + 1)%nat with (i + S n)%nat in far by lia. simpl INR in far.
    pose proof (creeps_between place (p (i + n)%nat) (p (i + S n)%nat) m ltac:(lra) ltac:(lra)
      (slow (i + n)%nat ltac:(lia)) (slow (i + S n)%nat ltac:(lia))). lra.
Qed.

(* Lemma 2 for several calls. *)
Lemma moves_throughout i n t :
  from <= p i -> (forall j, (i <= j <= i + n)%nat -> r + dip < v (p j)) -> p i <= t <= p (i + n)%nat -> r < v t.
Proof.
  intros h fast [lo hi]. induction n as [| n IH].
  - rewrite Nat.add_0_r in hi. assert (t = p i) as -> by lra. pose proof (fast i ltac:(lia)).
    assert (0 <= dip); [| lra]. unfold dip. destruct ok.
    apply Rmult_le_pos; [lra |]. apply Rmult_le_pos; [nra | left; apply Rinv_0_lt_compat; lra].
  - destruct (Rle_dec t (p (i + n)%nat)) as [early | late].
    + apply IH; auto. intros j hj. apply fast. lia.
    + pose proof (spacing k p grid_p (i + n) 1) as [_ SP]. replace (i + n + 1)%nat with (i + S n)%nat in SP by lia. simpl INR in SP.
      assert (from <= p (i + n)%nat).
      { apply Rle_trans with (p i); [exact h |]. apply (calls_ordered k p ok grid_p). lia. }
      apply (moves_between (p (i + n)%nat) t (p (i + S n)%nat)); [lra | lra | lra | apply fast; lia | apply fast; lia].
Qed.

(* The first call of Q from a time on. *)
Lemma next_call t : q 0%nat <= t -> exists i, q i < t + period k + 2 * jitter k /\ t <= q i.
Proof.
  intros started.
  assert (p0 : 0 < period k) by (destruct ok; lra).
  assert (far : exists n, t <= q n).
  { destruct (archimed ((t - q 0%nat + 2 * jitter k) / period k)) as [A _].
    set (y := (t - q 0%nat + 2 * jitter k) / period k) in *. exists (Z.to_nat (Z.max 0 (up y))).
    destruct (spacing k q grid_q 0 (Z.to_nat (Z.max 0 (up y)))) as [L _]. simpl plus in L.
    rewrite INR_IZR_INZ, Z2Nat.id in L by lia.
    assert (IZR (up y) <= IZR (Z.max 0 (up y))) by (apply IZR_le; lia).
    assert (E : y * period k = t - q 0%nat + 2 * jitter k) by (unfold y; field; lra).
    assert (y * period k <= IZR (Z.max 0 (up y)) * period k) by (apply Rmult_le_compat_r; lra).
    lra. }
  destruct far as [n N]. induction n as [| n IH].
  - exists O. destruct ok. lra.
  - destruct (Rle_dec t (q n)) as [? | after_]; [auto |].
    exists (S n). split; [| exact N].
    pose proof (spacing k q grid_q n 1) as [_ SP]. replace (n + 1)%nat with (S n) in SP by lia. simpl INR in SP. lra.
Qed.

(* Lemma 3: if enough calls of P show motion, Q has a call among them at which the vehicle is above r. *)
Lemma seen_to_move i m :
  enough m -> from <= p i -> q 0%nat <= p i -> (forall j, (i <= j <= i + (m - 1))%nat -> r + dip < v (p j)) ->
  exists j, p i <= q j <= p (i + (m - 1))%nat /\ r < v (q j).
Proof.
  intros en h started fast. destruct (next_call (p i) started) as (j & early & late).
  pose proof (enough_time m i en). exists j. split; [lra |].
  apply moves_throughout with i (m - 1)%nat; auto. lra.
Qed.

(* The counts of one vehicle, which arrives at a time. At time x, S of Q counts q's calls in a row that are sure of rest after
   the arrival; L of P counts p's calls since the last one at which it ended. *)
Variables (arrival : R).

Definition surely (x : R) (a count : nat) (sure : nat -> Prop) :=
  (forall j, sure j -> v (q j) <= r /\ arrival <= q j) /\
  (forall j, (a <= j < a + count)%nat -> sure j) /\ (forall j, q j <= x -> (j < a + count)%nat) /\
  (count <> 0%nat -> q (a + count - 1)%nat <= x).

Definition ended (m i : nat) :=
  p i < arrival \/ ((m - 1 <= i)%nat /\ forall j, (i - (m - 1) <= j <= i)%nat -> r + dip < v (p j)).

Definition perhaps (x : R) (m e count : nat) :=
  ended m e /\ p (e + count)%nat <= x < p (e + count + 1)%nat.

(* A stretch of rest that goes on until after a count ended began after it ended. *)
Lemma stretch_began m a last sure e :
  enough m -> from <= p 0%nat ->
  (forall j, sure j -> v (q j) <= r /\ arrival <= q j) -> (forall j, (a <= j <= last)%nat -> sure j) -> (a <= last)%nat ->
  ended m e -> p e < q (last + 1)%nat -> p e < q a.
Proof.
  intros en h sure_says stretch nonempty end_ goes_on.
  assert (fromp : forall i, from <= p i).
  { intros i. apply Rle_trans with (p 0%nat); [exact h | apply (calls_ordered k p ok grid_p); lia]. }
  assert (order_q : forall i j, (i <= j)%nat -> q i <= q j) by (apply (calls_ordered k q ok grid_q)).
  destruct end_ as [absent | [back fast]].
  - destruct (sure_says a (stretch a ltac:(lia))). lra.
  - destruct (Rlt_le_dec (p e) (q a)) as [? | before]; [assumption | exfalso].
    set (i := (e - (m - 1))%nat) in *. assert (ie : (i + (m - 1) = e)%nat) by (unfold i; lia).
    destruct (Rle_dec (p i) (q a)) as [within | earlier].
    + destruct (sure_says a (stretch a ltac:(lia))) as [rest _].
      assert (r < v (q a)); [| lra].
      apply moves_throughout with i (m - 1)%nat; auto; [intros j hj; apply fast; lia | rewrite ie; lra].
    + destruct (seen_to_move i m en (fromp i)) as (j & hj & moving).
      * pose proof (order_q O a ltac:(lia)). lra.
      * intros j hj. apply fast. lia.
      * rewrite ie in hj.
        assert (a <= j)%nat.
        { destruct (le_lt_dec a j) as [? | lt]; [assumption | exfalso]. pose proof (order_q j a ltac:(lia)). lra. }
        assert (j <= last)%nat.
        { destruct (le_lt_dec j last) as [? | lt]; [assumption | exfalso]. pose proof (order_q (last + 1)%nat j ltac:(lia)). lra. }
        destruct (sure_says j (stretch j ltac:(lia))). lra.
Qed.

(* Lemma 5: S of one shield exceeds L of the other by 1 at most without jitter, by 2 at most with it. *)
Theorem surely_at_most_perhaps x m a S_Q sure e L_P :
  enough m -> from <= p 0%nat ->
  surely x a S_Q sure -> perhaps x m e L_P -> (S_Q <= L_P + (m - 1))%nat.
Proof.
  intros en h (sure_says & stretch & upto & last) (end_ & now1 & now2).
  destruct (Nat.eq_dec S_Q 0) as [? | nz]; [lia |]. specialize (last nz).
  assert (order_p : forall i j, (i <= j)%nat -> p i <= p j) by (apply (calls_ordered k p ok grid_p)).
  assert (pe : p e <= x) by (apply Rle_trans with (2 := now1); apply order_p; lia).
  (* The stretch of rest began after the count ended. *)
  assert (began : p e < q a).
  { apply (stretch_began m a (a + S_Q - 1) sure e en h sure_says); [intros; apply stretch; lia | lia | exact end_ |].
    destruct (Rlt_le_dec x (q (a + S_Q - 1 + 1)%nat)) as [? | late]; [lra | exfalso].
    pose proof (upto _ late). lia. }
  (* So many calls of Q fit in. *)
  pose proof (spacing k q grid_q a (S_Q - 1)) as [LQ _]. replace (a + (S_Q - 1))%nat with (a + S_Q - 1)%nat in LQ by lia.
  pose proof (spacing k p grid_p e (L_P + 1)) as [_ UP]. replace (e + (L_P + 1))%nat with (e + L_P + 1)%nat in UP by lia.
  assert (p0 : 0 < period k) by (destruct ok; lra).
  assert (fit : INR (S_Q - 1) * period k < INR (L_P + 1) * period k + 4 * jitter k) by lra.
  destruct (le_lt_dec S_Q (L_P + (m - 1))) as [? | more]; [assumption | exfalso].
  destruct en as [[-> j0] | [-> j8]].
  - assert (INR (L_P + 1) <= INR (S_Q - 1)) by (apply le_INR; lia).
    assert (INR (L_P + 1) * period k <= INR (S_Q - 1) * period k) by (apply Rmult_le_compat_r; lra). lra.
  - assert (INR (L_P + 1) + 1 <= INR (S_Q - 1)) by (rewrite <- S_INR; apply le_INR; lia).
    assert ((INR (L_P + 1) + 1) * period k <= INR (S_Q - 1) * period k) by (apply Rmult_le_compat_r; lra). lra.
Qed.
End Rest.
