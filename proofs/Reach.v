(* The bounds on motion that the shield computes hold every motion that they are about. *)
Require Import Reals Lra Psatz.
Require Import Contract Shipped Motion.
Open Scope R_scope.

(* C2: the acceleration is at most a, up to the speed cap; who is faster than the cap keeps at most its speed. *)
Definition rushes_at_most (w : R -> R) (a cap t1 t2 : R) :=
  forall t t', t1 <= t -> t <= t' -> t' <= t2 -> w t' <= Rmin (w t + a * (t' - t)) (Rmax cap (w t)).

(* C2: the braking is at most b. *)
Definition brakes_at_most (w : R -> R) (b t1 t2 : R) :=
  forall t t', t1 <= t -> t <= t' -> t' <= t2 -> w t - b * (t' - t) <= w t'.

(* The slope of a line from P to Q. *)
Lemma slope P Q dt : 0 < dt -> exists q, P + q * dt = Q.
Proof. intros. exists ((Q - P) / dt). field. lra. Qed.

(** * at_most *)

Lemma at_most_holds s v s0 a r t1 t2 :
  motion s v -> t1 <= t2 -> speeds_up_at_most v a t1 t2 ->
  s t1 - s0 <= distance r -> v t1 <= speed r ->
  s t2 - s0 <= distance (at_most r a (t2 - t1)) /\ v t2 <= speed (at_most r a (t2 - t1)).
Proof.
  intros m le up d1 v1. cbn.
  pose proof (forwards s v m) as pos.
  set (dt := t2 - t1) in *.
  set (V := Rmax (speed r + a * dt) 0).
  assert (V0 : 0 <= V /\ speed r + a * dt <= V) by (unfold V; cases; lra).
  assert (vend : v t2 <= V).
  { pose proof (up t1 t2 ltac:(lra) ltac:(lra) ltac:(lra)) as UP. fold dt in UP. revert UP. cases; lra. }
  split; [| exact vend].
  destruct (Req_dec dt 0) as [z | nz].
  { assert (t2 = t1) by (unfold dt in z; lra). subst t2. rewrite z. lra. }
  assert (dt > 0) by (unfold dt in *; lra).
  destruct (slope (speed r) V dt ltac:(lra)) as (q & Q).
  pose proof (pos t1).
  assert (a <= q) by nra.
  assert (line : forall u, t1 <= u <= t2 -> v u <= speed r + q * (u - t1)).
  { intros u [lo hi]. pose proof (up t1 u ltac:(lra) ltac:(lra) ltac:(lra)) as UP.
    assert (0 <= speed r + q * (u - t1)).
    { destruct (Rle_dec 0 q); [nra |]. assert (q * dt <= q * (u - t1)) by (unfold dt; nra). lra. }
    assert (a * (u - t1) <= q * (u - t1)) by nra.
    revert UP. cases; lra. }
  pose proof (below_line s v (speed r) q t1 t2 m le line) as B. fold dt in B.
  replace (q * dt * dt / 2) with ((V - speed r) * dt / 2) in B by (rewrite <- Q; field).
  lra.
Qed.

Lemma at_most_speed_nonneg r a x : 0 <= speed (at_most r a x).
Proof. cbn. apply Rmax_r. Qed.

(** * Braking to rest *)

(* L8, L9: who brakes at b or harder gets no farther than to the place of rest. *)
Lemma stops_by s v b V t1 t2 :
  motion s v -> 0 < b -> t1 <= t2 -> speeds_up_at_most v (- b) t1 t2 -> v t1 <= V ->
  s t2 - s t1 <= V * V / (b + b).
Proof.
  intros m b0 le up v1. pose proof (forwards s v m) as pos. pose proof (pos t1).
  set (x := V / b).
  assert (X : b * x = V) by (unfold x; field; lra).
  assert (x0 : 0 <= x) by (unfold x; apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
  assert (R : V * V / (b + b) = b * x * x / 2) by (rewrite <- X; field; lra).
  assert (first : forall u, t1 <= u <= t2 -> u <= t1 + x -> s u - s t1 <= V * V / (b + b)).
  { intros u [lo hi] early.
    pose proof (below_line s v V (- b) t1 u m lo) as B.
    assert (line : forall t, t1 <= t <= u -> v t <= V + - b * (t - t1)).
    { intros t [? ?]. pose proof (up t1 t ltac:(lra) ltac:(lra) ltac:(lra)) as UP.
      assert (b * (t - t1) <= b * x) by nra. revert UP. cases; lra. }
    specialize (B line). rewrite R. rewrite <- X in B.
    assert (0 <= b * ((x - (u - t1)) * (x - (u - t1)))) by (apply Rmult_le_pos; [lra | apply Rle_0_sqr]). lra. }
  destruct (Rle_dec t2 (t1 + x)) as [early | late]; [apply first; lra |].
  assert (s t2 - s (t1 + x) <= 0).
  { pose proof (below_line s v 0 0 (t1 + x) t2 m ltac:(lra)) as B.
    assert (line : forall t, t1 + x <= t <= t2 -> v t <= 0 + 0 * (t - (t1 + x))).
    { intros t [? ?]. pose proof (up t1 t ltac:(lra) ltac:(lra) ltac:(lra)) as UP.
      assert (b * x <= b * (t - t1)) by nra. revert UP. cases; lra. }
    specialize (B line). lra. }
  pose proof (first (t1 + x) ltac:(lra) ltac:(lra)). lra.
Qed.

(* Nor does the place of rest move on. *)
Lemma rests_by s v b V t1 t2 :
  motion s v -> 0 < b -> t1 <= t2 -> speeds_up_at_most v (- b) t1 t2 -> v t1 <= V ->
  s t2 - s t1 + v t2 * v t2 / (b + b) <= V * V / (b + b).
Proof.
  intros m b0 le up v1. pose proof (forwards s v m) as pos. pose proof (pos t1). pose proof (pos t2).
  destruct (Req_dec (v t2) 0) as [z | nz].
  { rewrite z. pose proof (stops_by s v b V t1 t2 m b0 le up v1). replace (0 * 0 / (b + b)) with 0 by (field; lra). lra. }
  assert (line : forall u, t1 <= u <= t2 -> v u <= V + - b * (u - t1)).
  { intros u [? ?]. pose proof (up u t2 ltac:(lra) ltac:(lra) ltac:(lra)) as U2.
    pose proof (up t1 u ltac:(lra) ltac:(lra) ltac:(lra)) as U1. revert U1 U2.
    assert (0 <= b * (t2 - u)) by (apply Rmult_le_pos; lra). pose proof (pos u). cases; lra. }
  pose proof (below_line s v V (- b) t1 t2 m le line) as B. pose proof (line t2 ltac:(lra)) as L.
  assert (v t2 * v t2 / (b + b) <= (V - b * (t2 - t1)) * (V - b * (t2 - t1)) / (b + b)).
  { apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | nra]. }
  replace (V * V / (b + b)) with
    (V * (t2 - t1) + - b * (t2 - t1) * (t2 - t1) / 2 + (V - b * (t2 - t1)) * (V - b * (t2 - t1)) / (b + b)) by (field; lra).
  lra.
Qed.

(* From within r, braking at b or harder, the ego is at rest by rest_of r b. *)
Lemma rest_holds s v s0 b r t1 t2 :
  motion s v -> 0 < b -> t1 <= t2 -> speeds_up_at_most v (- b) t1 t2 ->
  s t1 - s0 <= distance r -> v t1 <= speed r -> s t2 - s0 + v t2 * v t2 / (b + b) <= rest_of r b.
Proof.
  intros m b0 le up d1 v1.
  pose proof (rests_by s v b (speed r) t1 t2 m b0 le up v1). unfold rest_of. lra.
Qed.

(* Who is within a reach would be at rest by its place of rest. *)
Lemma rest_of_within (s v : R -> R) s0 b r t :
  0 < b -> 0 <= v t -> s t - s0 <= distance r -> v t <= speed r ->
  s t - s0 + v t * v t / (b + b) <= rest_of r b.
Proof.
  intros. unfold rest_of.
  assert (v t * v t / (b + b) <= speed r * speed r / (b + b)); [| lra].
  apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | nra].
Qed.

(* L9 for a bound: braking no harder than b for a while moves the place of rest no nearer. *)
Lemma at_most_rest_grows r a b x y :
  0 <= speed r -> 0 < b -> - b <= a -> 0 <= x <= y ->
  rest_of (at_most r a x) b <= rest_of (at_most r a y) b.
Proof.
  intros v0 b0 ab [x0 xy]. unfold rest_of. cbn. set (P := speed r) in *.
  assert (two : forall z, z / (b + b) * (b + b) = z) by (intros; field; lra).
  assert (positive : forall p q, 0 <= p -> p <= q -> 0 <= P + a * p -> 0 <= P + a * q ->
            (P + (P + a * p)) * p * (1 / 2) + (P + a * p) * (P + a * p) / (b + b)
            <= (P + (P + a * q)) * q * (1 / 2) + (P + a * q) * (P + a * q) / (b + b)).
  { intros p q ? ? ? ?. apply Rmult_le_reg_r with (b + b); [lra |]. rewrite !Rmult_plus_distr_r, !two.
    assert (0 <= (q - p) * (b + a) * ((P + a * p) + (P + a * q))) by (repeat apply Rmult_le_pos; lra). lra. }
  destruct (Rle_dec 0 (P + a * x)), (Rle_dec 0 (P + a * y)).
  - rewrite !Rmax_left by lra. pose proof (positive x y ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)). lra.
  - rewrite Rmax_left, Rmax_right by lra.
    assert (a < 0) by nra.
    set (z := P / - a). assert (Z : P + a * z = 0) by (unfold z; field; lra).
    assert (x <= z) by nra. assert (z <= y) by nra.
    pose proof (positive x z ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)) as A. rewrite Z in A.
    assert (P * z <= P * y) by (apply Rmult_le_compat_l; lra).
    replace (0 * 0 / (b + b)) with 0 in * by (field; lra). lra.
  - exfalso. assert (a < 0) by nra. assert (a * y <= a * x) by nra. lra.
  - rewrite !Rmax_right by lra. assert (P * x <= P * y) by (apply Rmult_le_compat_l; lra). lra.
Qed.

(** * at_least *)

Lemma at_least_holds s v s0 a cap r t1 t2 :
  motion s v -> t1 <= t2 -> speeds_up_at_least v a cap t1 t2 ->
  0 <= speed r -> distance r <= s t1 - s0 -> speed r <= v t1 ->
  distance (at_least r a cap (t2 - t1)) <= s t2 - s0 /\ speed (at_least r a cap (t2 - t1)) <= v t2.
Proof.
  intros m le up r0 d1 v1. cbn.
  pose proof (forwards s v m) as pos.
  set (dt := t2 - t1) in *.
  set (V := Rmin (speed r + a * dt) (Rmax cap (speed r))).
  assert (vend : V <= v t2).
  { pose proof (up t1 t2 ltac:(lra) ltac:(lra) ltac:(lra)) as UP. fold dt in UP. revert UP. unfold V. cases; lra. }
  split; [| pose proof (pos t2); cases; lra].
  pose proof (advances s v t1 t2 m le).
  assert ((speed r + V) * dt * (1 / 2) <= s t2 - s t1); [| cases; lra].
  destruct (Req_dec dt 0) as [z | nz]; [rewrite z; lra |].
  assert (dt > 0) by (unfold dt in *; lra).
  destruct (slope (speed r) V dt ltac:(lra)) as (q & Q).
  assert (V <= speed r + a * dt /\ V <= Rmax cap (speed r)).
  { unfold V. split; [apply Rmin_l | apply Rmin_r]. }
  assert (q <= a) by nra.
  assert (line : forall u, t1 <= u <= t2 -> speed r + q * (u - t1) <= v u).
  { intros u [lo hi]. pose proof (up t1 u ltac:(lra) ltac:(lra) ltac:(lra)) as UP.
    assert (q * (u - t1) <= a * (u - t1)) by nra.
    assert (speed r + q * (u - t1) <= Rmax cap (speed r)).
    { destruct (Rle_dec q 0).
      - apply Rle_trans with (speed r); [nra | apply Rmax_r].
      - assert (q * (u - t1) <= q * dt) by (unfold dt; nra). lra. }
    assert (Rmax cap (speed r) <= Rmax cap (v t1)) by (apply Rle_max_compat_l; lra).
    revert UP. destruct (Rmin_spec (v t1 + a * (u - t1)) (Rmax cap (v t1))) as [[? ->] | [? ->]]; lra. }
  pose proof (above_line s v (speed r) q t1 t2 m le line) as B. fold dt in B.
  replace (q * dt * dt / 2) with ((V - speed r) * dt / 2) in B by (rewrite <- Q; field).
  lra.
Qed.

Lemma at_least_speed_nonneg r a cap x : 0 <= speed (at_least r a cap x).
Proof. cbn. apply Rmax_r. Qed.

(** * rushing *)

(* L5: an other is within rushing, at any later time. *)
Lemma rushing_holds s v s0 a cap r t1 t2 :
  motion s v -> 0 < a -> t1 <= t2 -> rushes_at_most v a cap t1 t2 ->
  s t1 - s0 <= distance r -> v t1 <= speed r ->
  s t2 - s0 <= distance (rushing r a cap (t2 - t1)) /\ v t2 <= speed (rushing r a cap (t2 - t1)).
Proof.
  intros m a0 le up d1 v1. cbn.
  set (C := Rmax cap (speed r)).
  set (x := (C - speed r) / a).
  assert (CC : speed r <= C) by apply Rmax_r.
  assert (X : a * x = C - speed r) by (unfold x; field; lra).
  assert (x0 : 0 <= x) by (unfold x; apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
  assert (both : forall u, t1 <= u <= t2 -> v u <= speed r + a * (u - t1) /\ v u <= C).
  { intros u [? ?]. pose proof (up t1 u ltac:(lra) ltac:(lra) ltac:(lra)) as UP.
    assert (Rmax cap (v t1) <= C) by (apply Rle_max_compat_l; lra).
    pose proof (Rmin_l (v t1 + a * (u - t1)) (Rmax cap (v t1))).
    pose proof (Rmin_r (v t1 + a * (u - t1)) (Rmax cap (v t1))). lra. }
  split; [| destruct (both t2 ltac:(lra)); cases; lra].
  assert (first : forall u, t1 <= u <= t2 -> s u - s t1 <= (speed r + a * (u - t1) * (1 / 2)) * (u - t1)).
  { intros u [? ?]. pose proof (below_line s v (speed r) a t1 u m ltac:(lra)) as B.
    specialize (B ltac:(intros t [? ?]; apply both; lra)). lra. }
  destruct (Rle_dec (t2 - t1) x) as [early | late].
  - rewrite Rmin_left by lra. rewrite Rmax_right by lra. pose proof (first t2 ltac:(lra)). lra.
  - rewrite Rmin_right by lra. rewrite Rmax_left by lra.
    pose proof (first (t1 + x) ltac:(lra)) as F.
    replace (t1 + x - t1) with x in F by ring.
    pose proof (below_line s v C 0 (t1 + x) t2 m ltac:(lra)) as B.
    specialize (B ltac:(intros t [? ?]; destruct (both t ltac:(lra)); lra)). lra.
Qed.

(* The speed after rushing. *)
Lemma rushing_speed r a cap x :
  speed (rushing r a cap x) = Rmin (Rmax cap (speed r)) (speed r + a * x).
Proof. reflexivity. Qed.

(* The ramp and what comes after it, without a minimum. *)
Lemma rushing_early r a cap x :
  0 < a -> 0 <= x -> speed r + a * x <= Rmax cap (speed r) ->
  distance (rushing r a cap x) = distance r + (speed r + a * x * (1 / 2)) * x /\
  speed (rushing r a cap x) = speed r + a * x.
Proof.
  intros a0 x0 early. cbn. set (C := Rmax cap (speed r)) in *.
  assert (x <= (C - speed r) / a) by (apply Rmult_le_reg_l with a; [lra |]; field_simplify; lra).
  rewrite (Rmin_left x), (Rmax_right (x - _)), Rmin_right by lra. split; [ring | reflexivity].
Qed.

Lemma rushing_late r a cap x :
  0 < a -> 0 <= x -> Rmax cap (speed r) <= speed r + a * x ->
  distance (rushing r a cap x) =
    distance r + (Rmax cap (speed r) * Rmax cap (speed r) - speed r * speed r) / (2 * a)
    + Rmax cap (speed r) * (x - (Rmax cap (speed r) - speed r) / a) /\
  speed (rushing r a cap x) = Rmax cap (speed r).
Proof.
  intros a0 x0 late. cbn. set (C := Rmax cap (speed r)) in *.
  assert ((C - speed r) / a <= x) by (apply Rmult_le_reg_l with a; [lra |]; field_simplify; lra).
  rewrite (Rmin_right x), (Rmax_left (x - _)), Rmin_left by lra. split; [field; lra | reflexivity].
Qed.

(* L6: rushing for a time and then another is rushing for both. *)
Lemma rushing_on r a cap x y :
  0 < a -> 0 <= x -> 0 <= y -> rushing (rushing r a cap x) a cap y = rushing r a cap (x + y).
Proof.
  intros a0 x0 y0.
  assert (ext : forall p q, distance p = distance q -> speed p = speed q -> p = q).
  { intros [] []. cbn. intros -> ->. reflexivity. }
  assert (ay : 0 <= a * y) by nra. assert (ax : 0 <= a * x) by nra.
  pose proof (Rmax_r cap (speed r)). pose proof (Rmax_l cap (speed r)).
  destruct (Rle_dec (speed r + a * x) (Rmax cap (speed r))) as [e | l].
  - destruct (rushing_early r a cap x a0 x0 e) as [d1 v1].
    assert (C : Rmax cap (speed r + a * x) = Rmax cap (speed r)).
    { apply Rle_antisym; [apply Rmax_lub; lra | apply Rle_max_compat_l; lra]. }
    destruct (Rle_dec (speed r + a * (x + y)) (Rmax cap (speed r))) as [e2 | l2].
    + destruct (rushing_early r a cap (x + y) a0 ltac:(lra) e2) as [d2 v2].
      destruct (rushing_early (rushing r a cap x) a cap y a0 y0) as [d3 v3]; [rewrite v1, C; lra |].
      apply ext; [rewrite d3, d2, d1, v1; field | rewrite v3, v2, v1; ring].
    + destruct (rushing_late r a cap (x + y) a0 ltac:(lra) ltac:(lra)) as [d2 v2].
      destruct (rushing_late (rushing r a cap x) a cap y a0 y0) as [d3 v3]; [rewrite v1, C; lra |].
      apply ext; [rewrite d3, d2, d1, v1, C; field; lra | rewrite v3, v2, v1, C; ring].
  - destruct (rushing_late r a cap x a0 x0 ltac:(lra)) as [d1 v1].
    assert (C : Rmax cap (Rmax cap (speed r)) = Rmax cap (speed r)) by (apply Rmax_right; lra).
    destruct (rushing_late r a cap (x + y) a0 ltac:(lra) ltac:(lra)) as [d2 v2].
    destruct (rushing_late (rushing r a cap x) a cap y a0 y0) as [d3 v3]; [rewrite v1, C; lra |].
    apply ext; [rewrite d3, d2, d1, v1, C; field; lra | rewrite v3, v2, v1, C; ring].
Qed.

Lemma rushing_speed_grows r a cap x y :
  0 < a -> x <= y -> speed (rushing r a cap x) <= speed (rushing r a cap y).
Proof. intros a0 xy. cbn. assert (a * x <= a * y) by nra. cases; lra. Qed.

Lemma rushing_no_nearer r a cap x :
  0 < a -> 0 <= x -> 0 <= speed r -> distance r <= distance (rushing r a cap x).
Proof.
  intros a0 x0 v0. cbn.
  pose proof (Rmax_r cap (speed r)).
  set (X := (Rmax cap (speed r) - speed r) / a).
  assert (0 <= X) by (unfold X; apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
  assert (0 <= Rmin x X) by (apply Rmin_glb; lra).
  assert (0 <= Rmax (x - X) 0) by apply Rmax_r.
  assert (0 <= (speed r + a * Rmin x X * (1 / 2)) * Rmin x X) by (apply Rmult_le_pos; nra).
  assert (0 <= Rmax cap (speed r) * Rmax (x - X) 0) by (apply Rmult_le_pos; lra).
  lra.
Qed.

Lemma rushing_grows r a cap x y :
  0 < a -> 0 <= x <= y -> 0 <= speed r -> distance (rushing r a cap x) <= distance (rushing r a cap y).
Proof.
  intros a0 [x0 xy] v0.
  replace y with (x + (y - x)) by ring. rewrite <- rushing_on by lra.
  apply rushing_no_nearer; [lra | lra |]. cbn. assert (0 <= a * x) by nra.
  pose proof (Rmax_r cap (speed r)). cases; lra.
Qed.

(* A faster vehicle gets farther. *)
Lemma rushing_monotone d v w a cap x :
  0 < a -> 0 <= x -> v <= w ->
  distance (rushing {| distance := d; speed := v |} a cap x) <= distance (rushing {| distance := d; speed := w |} a cap x) /\
  speed (rushing {| distance := d; speed := v |} a cap x) <= speed (rushing {| distance := d; speed := w |} a cap x).
Proof.
  intros a0 x0 vw. cbn.
  assert (CC : Rmax cap v <= Rmax cap w) by (apply Rle_max_compat_l; lra).
  split; [| cases; lra].
  set (p := {| distance := d; speed := v |}). set (q := {| distance := d; speed := w |}).
  pose proof (Rmax_l cap v). pose proof (Rmax_r cap v). pose proof (Rmax_r cap w).
  change (distance (rushing p a cap x) <= distance (rushing q a cap x)).
  set (C := Rmax cap v) in *. set (D := Rmax cap w) in *.
  assert (ax : 0 <= a * x) by nra.
  assert (P : distance (rushing p a cap x) * (2 * a) = d * (2 * a) +
    (if Rle_dec (v + a * x) C then (2 * v + a * x) * (a * x) else C * C - v * v + 2 * C * (a * x - (C - v)))).
  { destruct (Rle_dec (v + a * x) C) as [e | l].
    - destruct (rushing_early p a cap x a0 x0 e) as [E _]. rewrite E. cbn. field.
    - destruct (rushing_late p a cap x a0 x0) as [E _]; [cbn; fold C; lra |]. rewrite E. cbn. fold C. field. lra. }
  assert (Q : distance (rushing q a cap x) * (2 * a) = d * (2 * a) +
    (if Rle_dec (w + a * x) D then (2 * w + a * x) * (a * x) else D * D - w * w + 2 * D * (a * x - (D - w)))).
  { destruct (Rle_dec (w + a * x) D) as [e | l].
    - destruct (rushing_early q a cap x a0 x0 e) as [E _]. rewrite E. cbn. field.
    - destruct (rushing_late q a cap x a0 x0) as [E _]; [cbn; fold D; lra |]. rewrite E. cbn. fold D. field. lra. }
  apply Rmult_le_reg_r with (2 * a); [lra |]. rewrite P, Q.
  destruct (Rle_dec (v + a * x) C), (Rle_dec (w + a * x) D); nra.
Qed.

(** * until *)

(* The time until the target: what until computes, as a ramp and a steady part. *)
Lemma until_is r target g cap :
  0 < g -> 0 < cap -> 0 <= speed r ->
  let left := Rmax (target - distance r) 0 in
  let C := Rmax cap (speed r) in
  let V := snd (until r target g cap) in
  exists ramp steady, fst (until r target g cap) = ramp + steady /\ 0 <= ramp /\ 0 <= steady /\
    V = speed r + g * ramp /\ V <= C /\
    (speed r + V) * ramp * (1 / 2) + C * steady = left /\ (0 < steady -> V = C).
Proof.
  intros g0 cap0 rr0. cbn zeta. unfold until. cbn [fst snd].
  set (left := Rmax (target - distance r) 0). set (C := Rmax cap (speed r)).
  assert (C0 : 0 < C /\ speed r <= C).
  { split; [| apply Rmax_r]. apply Rlt_le_trans with cap; [| apply Rmax_l].
    exact cap0. }
  assert (left0 : 0 <= left) by apply Rmax_r.
  set (limit := (C - speed r) * (C + speed r) / (g + g)).
  assert (L : limit * (2 * g) = C * C - speed r * speed r) by (unfold limit; field; lra).
  assert (limit0 : 0 <= limit).
  { unfold limit. apply Rmult_le_pos; [apply Rmult_le_pos; lra | left; apply Rinv_0_lt_compat; lra]. }
  set (ramp_way := Rmin left limit).
  assert (rw : 0 <= ramp_way /\ ramp_way <= left /\ ramp_way <= limit).
  { unfold ramp_way. repeat split; [apply Rmin_glb; lra | apply Rmin_l | apply Rmin_r]. }
  set (V := sqrt (speed r * speed r + (g + g) * ramp_way)).
  assert (in0 : 0 <= speed r * speed r + (g + g) * ramp_way) by nra.
  assert (V0 : 0 <= V) by apply sqrt_pos.
  assert (VV : V * V = speed r * speed r + (g + g) * ramp_way) by (unfold V; apply sqrt_sqrt; exact in0).
  assert (Vr : speed r <= V) by nra.
  assert (VC : V <= C) by nra.
  assert (x : Rmax (V - speed r) 0 = V - speed r) by (apply Rmax_left; lra). rewrite x.
  exists ((V - speed r) / g), (Rmax (left - limit) 0 / C).
  split; [reflexivity |].
  split; [apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra] |].
  split; [apply Rmult_le_pos; [apply Rmax_r | left; apply Rinv_0_lt_compat; lra] |].
  split; [field; lra |]. split; [exact VC |].
  assert (w : (speed r + V) * ((V - speed r) / g) * (1 / 2) = ramp_way).
  { replace ((speed r + V) * ((V - speed r) / g) * (1 / 2))
      with ((V * V - speed r * speed r) / (2 * g)) by (field; lra). rewrite VV. field. lra. }
  rewrite w.
  split.
  - replace (C * (Rmax (left - limit) 0 / C)) with (Rmax (left - limit) 0) by (field; lra).
    unfold ramp_way. cases; lra.
  - intros st. assert (limit < left).
    { destruct (Rle_dec left limit) as [e | ne]; [| lra]. rewrite (Rmax_right (left - limit) 0) in st by lra.
      unfold Rdiv in st. rewrite Rmult_0_l in st. lra. }
    assert (ramp_way = limit) by (unfold ramp_way; apply Rmin_right; lra). nra.
Qed.
