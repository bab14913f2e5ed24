(* (i) for a drivetrain that is late, with several commands in flight, a lag, and an error: a plan stops where it says. *)
Require Import Reals Lra Lia Psatz List.
Require Import Contract Shipped Motion Reach Lag.
Open Scope R_scope.

(** * Bounds of several legs *)

(* A leg: how long it lasts, and an acceleration. *)
Fixpoint total (legs : list (R * R)) := match legs with nil => 0 | (d, _) :: rest => d + total rest end.

Fixpoint speed_at (r : reach) (legs : list (R * R)) (u : R) :=
  match legs with
  | nil => speed r
  | (d, q) :: rest => if Rle_dec u d then speed (at_most r q u) else speed_at (at_most r q d) rest (u - d)
  end.

Definition after_legs := fold_left (fun r (leg : R * R) => at_most r (snd leg) (fst leg)).

Definition ordered (legs : list (R * R)) := Forall (fun leg => 0 <= fst leg) legs.

Lemma total_nonneg legs : ordered legs -> 0 <= total legs.
Proof. induction 1 as [| [d q] legs h _ IH]; cbn in *; lra. Qed.

Lemma at_most_keeps r q d : 0 <= speed (at_most r q d).
Proof. cbn. apply Rmax_r. Qed.

Lemma at_most_rises r q d1 d2 : 0 <= speed r -> 0 <= d1 <= d2 ->
  q * (d2 - d1) <= speed (at_most r q d2) - speed (at_most r q d1).
Proof.
  intros r0 [d10 d12]. cbn. set (s := speed r) in *.
  assert (Q : q * (d2 - d1) = q * d2 - q * d1) by ring.
  destruct (Rle_dec 0 q).
  - assert (0 <= q * d1) by nra. assert (0 <= q * (d2 - d1)) by nra. cases; lra.
  - assert (q * (d2 - d1) <= 0) by nra. cases; lra.
Qed.

Lemma speed_at_nonneg legs : forall r u, 0 <= speed r -> 0 <= speed_at r legs u.
Proof.
  induction legs as [| [d q] legs IH]; intros r u r0; cbn; [exact r0 |].
  destruct (Rle_dec u d); [apply Rmax_r | apply IH, at_most_keeps].
Qed.

Lemma speed_at_first legs : forall r, ordered legs -> 0 <= speed r -> speed_at r legs 0 = speed r.
Proof.
  destruct legs as [| [d q] legs]; intros r ord r0; [reflexivity |].
  inversion ord as [| leg ? d0 ?]; subst. cbn in *. destruct (Rle_dec 0 d); [| lra]. cbn. rewrite Rmax_left; lra.
Qed.

(* Under the speed of the legs an ego gets no farther, and would rest no farther, than they say. *)
Lemma one_leg s v r q o u s0 : motion s v -> 0 <= speed r -> o <= u ->
  (forall t, o <= t <= u -> v t <= speed (at_most r q (t - o))) -> s o - s0 <= distance r ->
  s u - s0 <= distance (at_most r q (u - o)).
Proof.
  intros m r0 le below so. cbn. set (dt := u - o) in *.
  set (V := Rmax (speed r + q * dt) 0).
  destruct (Req_dec dt 0) as [z | nz].
  { assert (u = o) by (unfold dt in z; lra). subst u. rewrite z. lra. }
  assert (dt > 0) by (unfold dt in *; lra).
  assert (V0 : 0 <= V /\ speed r + q * dt <= V) by (unfold V; cases; lra).
  destruct (slope (speed r) V dt ltac:(lra)) as (p & Q).
  assert (q <= p) by nra.
  assert (line : forall t, o <= t <= u -> v t <= speed r + p * (t - o)).
  { intros t [lo hi]. pose proof (below t ltac:(lra)) as B. cbn in B.
    assert (0 <= speed r + p * (t - o)).
    { destruct (Rle_dec 0 p); [nra |]. assert (p * dt <= p * (t - o)) by (unfold dt; nra). lra. }
    assert (q * (t - o) <= p * (t - o)) by nra. revert B. cases; lra. }
  pose proof (below_line s v (speed r) p o u m le line) as B. fold dt in B.
  replace (p * dt * dt / 2) with ((V - speed r) * dt / 2) in B by (rewrite <- Q; field). lra.
Qed.

Lemma rest_grows b legs : 0 < b -> forall r, ordered legs -> Forall (fun leg => - b <= snd leg) legs -> 0 <= speed r ->
  rest_of r b <= rest_of (after_legs legs r) b.
Proof.
  intros b0. induction legs as [| [d q] legs IH]; intros r ord hard r0; [cbn; lra |].
  inversion ord as [| ? ? d0 ord']; subst. inversion hard as [| ? ? q0 hard']; subst. cbn [fst snd] in *.
  change (after_legs ((d, q) :: legs) r) with (after_legs legs (at_most r q d)).
  pose proof (at_most_rest_grows r q b 0 d r0 b0 q0 ltac:(lra)) as G.
  assert (Z : rest_of (at_most r q 0) b = rest_of r b).
  { unfold rest_of. cbn. rewrite (Rmax_left (speed r + q * 0)) by lra.
    replace (speed r + q * 0) with (speed r) by ring. field. lra. }
  rewrite Z in G. apply Rle_trans with (1 := G). apply IH; auto. apply at_most_keeps.
Qed.

Lemma legs_hold s v s0 b E legs : motion s v -> 0 < b -> forall r o,
  ordered legs -> Forall (fun leg => - b <= snd leg) legs -> 0 <= speed r ->
  (forall t, o <= t <= o + total legs -> t <= E -> v t <= speed_at r legs (t - o)) ->
  s o - s0 <= distance r ->
  (forall u, o <= u <= o + total legs -> u <= E ->
     s u - s0 + v u * v u / (b + b) <= rest_of (after_legs legs r) b) /\
  (o + total legs <= E -> s (o + total legs) - s0 <= distance (after_legs legs r) /\
     v (o + total legs) <= speed (after_legs legs r)).
Proof.
  intros m b0. induction legs as [| [d q] legs IH]; intros r o ord hard r0 below so.
  - cbn in *. split; [| intros; rewrite Rplus_0_r; pose proof (below o ltac:(lra) ltac:(lra)); split; lra].
    intros u [? ?] ?. assert (u = o) by lra. subst u.
    pose proof (below o ltac:(lra) ltac:(lra)). apply rest_of_within; auto. apply (forwards s v m).
  - inversion ord as [| ? ? d0 ord']; subst. inversion hard as [| ? ? q0 hard']; subst. cbn [fst snd] in *.
    pose proof (total_nonneg legs ord') as t0. cbn [total] in *.
    change (after_legs ((d, q) :: legs) r) with (after_legs legs (at_most r q d)).
    assert (first : forall u, o <= u <= o + d -> u <= E -> s u - s0 <= distance (at_most r q (u - o)) /\
              v u <= speed (at_most r q (u - o))).
    { intros u [? ?] ?.
      assert (B : forall t, o <= t <= u -> v t <= speed (at_most r q (t - o))).
      { intros t [? ?]. pose proof (below t ltac:(lra) ltac:(lra)) as B. cbn [speed_at] in B.
        destruct (Rle_dec (t - o) d); [exact B | lra]. }
      split; [apply (one_leg s v r q o u s0); auto | apply B; lra]. }
    destruct (Rle_dec (o + d) E) as [on | ended].
    + destruct (first (o + d) ltac:(lra) on) as [D V]. replace (o + d - o) with d in D, V by ring.
      destruct (IH (at_most r q d) (o + d) ord' hard' (at_most_keeps r q d)) as [I1 I2]; [| exact D |].
      { intros t [? ?] ?. destruct (Req_dec t (o + d)) as [-> | ne].
        - replace (o + d - (o + d)) with 0 by ring. rewrite speed_at_first; auto. apply at_most_keeps.
        - pose proof (below t ltac:(lra) ltac:(lra)) as B. cbn [speed_at] in B.
          destruct (Rle_dec (t - o) d); [lra |]. replace (t - (o + d)) with (t - o - d) by ring. exact B. }
      split; [| intros hE; replace (o + (d + total legs)) with (o + d + total legs) in * by ring; auto].
      intros u [? ?] ?. destruct (Rle_dec u (o + d)) as [early | late_]; [| apply I1; lra].
      destruct (first u ltac:(lra) ltac:(lra)) as [D' V'].
      pose proof (rest_of_within s v s0 b _ u b0 (forwards s v m u) D' V').
      pose proof (at_most_rest_grows r q b (u - o) d r0 b0 q0 ltac:(lra)) as G1.
      pose proof (rest_grows b legs b0 (at_most r q d) ord' hard' (at_most_keeps r q d)). lra.
    + split; [| lra]. intros u [? ?] ?.
      destruct (first u ltac:(lra) ltac:(lra)) as [D' V'].
      pose proof (rest_of_within s v s0 b _ u b0 (forwards s v m u) D' V').
      pose proof (at_most_rest_grows r q b (u - o) d r0 b0 q0 ltac:(lra)) as G1.
      pose proof (rest_grows b legs b0 (at_most r q d) ord' hard' (at_most_keeps r q d)). lra.
Qed.

Lemma speed_at_last legs : forall r, ordered legs -> 0 <= speed r -> speed_at r legs (total legs) = speed (after_legs legs r).
Proof.
  induction legs as [| [d q] legs IH]; intros r ord r0; [reflexivity |].
  inversion ord as [| ? ? d0 ord']; subst. cbn [fst] in d0. pose proof (total_nonneg legs ord').
  change (after_legs ((d, q) :: legs) r) with (after_legs legs (at_most r q d)). cbn [total speed_at].
  rewrite <- IH; auto using at_most_keeps. destruct (Rle_dec (d + total legs) d) as [e | ne].
  - assert (z : total legs = 0) by lra. rewrite z, Rplus_0_r, speed_at_first; auto using at_most_keeps.
  - replace (d + total legs - d) with (total legs) by ring. reflexivity.
Qed.

(* Who is no faster than if it braked at b from the speed V rests where that one does, at the farthest. *)
Lemma brakes_out s v b V o u : motion s v -> 0 < b -> 0 <= V -> o <= u ->
  (forall t, o <= t <= u -> v t <= Rmax 0 (V - b * (t - o))) ->
  s u - s o + v u * v u / (b + b) <= V * V / (b + b).
Proof.
  intros m b0 V0 le below. pose proof (forwards s v m) as pos.
  set (x := V / b). assert (X : b * x = V) by (unfold x; field; lra).
  assert (x0 : 0 <= x) by (unfold x; apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
  assert (R : V * V / (b + b) = b * x * x / 2) by (rewrite <- X; field; lra).
  assert (line : forall w, o <= w <= u -> w <= o + x -> forall t, o <= t <= w -> v t <= V + - b * (t - o)).
  { intros w ? ? t [? ?]. pose proof (below t ltac:(lra)) as B. assert (b * (t - o) <= b * x) by (apply Rmult_le_compat_l; lra).
    revert B. cases; lra. }
  destruct (Rle_dec u (o + x)) as [early | late_].
  - pose proof (below_line s v V (- b) o u m le (line u ltac:(lra) early)) as B.
    pose proof (line u ltac:(lra) early u ltac:(lra)) as W. pose proof (pos u).
    assert (v u * v u / (b + b) <= (V - b * (u - o)) * (V - b * (u - o)) / (b + b)).
    { apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | nra]. }
    replace (V * V / (b + b)) with (V * (u - o) + - b * (u - o) * (u - o) / 2 + (V - b * (u - o)) * (V - b * (u - o)) / (b + b))
      by (field; lra). lra.
  - pose proof (below_line s v V (- b) o (o + x) m ltac:(lra) (line (o + x) ltac:(lra) ltac:(lra))) as B.
    replace (o + x - o) with x in B by ring.
    assert (slow : forall t, o + x <= t <= u -> v t <= 0).
    { intros t [? ?]. pose proof (below t ltac:(lra)) as W. assert (b * x <= b * (t - o)) by (apply Rmult_le_compat_l; lra).
      revert W. cases; lra. }
    pose proof (below_line s v 0 0 (o + x) u m ltac:(lra) ltac:(intros t ?; pose proof (slow t ltac:(lra)); lra)) as C.
    assert (z : v u = 0) by (pose proof (slow u ltac:(lra)); pose proof (pos u); lra).
    rewrite z, R. replace (0 * 0 / (b + b)) with 0 by (field; lra).
    assert (V * x + - b * x * x / 2 = b * x * x / 2) by (rewrite <- X; field). lra.
Qed.

(** * The drivetrain *)

(* C4, C5. Command c (S i) is given at call S i, and takes effect within the latency; until then those before it may act, in
   the order of the commands. What is followed differs from a command as D14 says; the pull is what has been followed in
   all. The speed without rest or limiter follows it with a time constant of at most the lag. The ego rests when it stops
   until it is pulled. *)

Section Drive.
Variables (k : drivetrain).

Record drives (theta : R) (v x pull : R -> R) (tau c : nat -> R) : Prop := {
  follows : lags theta x pull;
  constant_known : theta <= ego_lag k;
  pulls_up : forall t t' q, tau 1%nat <= t -> t <= t' ->
    (forall j, tau j < t' -> t < tau (S j) + latency k -> strongest k (c j) <= q) -> pull t' - pull t <= q * (t' - t);
  pulls_down : forall t t' q, tau 1%nat <= t -> t <= t' ->
    (forall j, tau j < t' -> t < tau (S j) + latency k -> q <= weakest k (c j)) -> q * (t' - t) <= pull t' - pull t;
  rests_when_stopped : goes_with v x pull 0
}.

(* A3 of a drivetrain, but for the number of commands in flight, which may be any. *)
Definition drivable := 0 < period k /\ 0 <= latency k /\ 0 <= jitter k /\ 0 < shortest_period k /\ 0 <= ego_lag k /\
  0 <= ego_gain k <= 1 / 2 /\ 0 <= ego_disturbance k /\ 0 < ego_go k /\ 0 < weakest k (ego_braking k).

(* What is inherited, as the loop of the code sees it: for how long, after the part before it, which accelerations may act,
   and whether the next period has begun. *)
Record part := { lasts : R; low : R; high : R; later : bool }.

(* D14. *)
Definition highest (a : R) (go : bool) (p : part) :=
  let h := Rmax (high p) (strongest k a) in
  if (later p && go)%bool then Rmax h (strongest k (ego_go k)) else h.

(* The legs of a plan from its call on: what is inherited; the rest of the first period, if that is not over; the response, or
   the period in which it certainly ends; n periods of go. *)
Definition legs_up (a : R) (n : nat) (late_ : bool) (parts : list part) :=
  let go := match n with O => false | S _ => true end in
  let last_ := if go then Rmax (strongest k a) (strongest k (ego_go k)) else strongest k a in
  map (fun p => (lasts p, highest a go p)) parts ++
  (if late_ then (shortest_period k, last_) :: nil
   else (shortest_period k - response k, strongest k a) :: (response k, last_) :: nil) ++
  (INR n * period k, strongest k (ego_go k)) :: nil.

Variables (theta : R) (s v x pull : R -> R) (tau c : nat -> R).
Hypothesis m : motion s v.
Hypothesis drive : drives theta v x pull tau c.
Hypothesis grid : exists start, forall i,
  start + INR i * period k - jitter k <= tau i <= start + INR i * period k + jitter k.
Hypothesis numbers : drivable.

(* Of the plan whose first command is given at call S i, what is inherited there is true: from [o] after the call on, less the
   lag, no command given before leads to more or less; nor does the acceleration itself, until the lag after the call. *)
Section Plan.
Variables (i n count : nat) (a sensed : R) (parts : list part) (late_ : bool).
Let T := tau (S i).
Let E := tau (S (S i) + count)%nat.
Let sp := shortest_period k.
Let rs := response k.

Fixpoint inherits (o : R) (parts : list part) : Prop :=
  match parts with
  | nil => o = rs
  | p :: rest =>
      0 <= lasts p /\ (later p = false -> o + lasts p <= sp) /\
      (forall j, (j <= i)%nat -> T + o - ego_lag k < tau (S j) + latency k ->
         low p <= weakest k (c j) /\ strongest k (c j) <= high p) /\
      (o < ego_lag k -> theta * low p <= pull T - x T <= theta * high p) /\
      inherits (o + lasts p) rest
  end.

Hypothesis inherited : inherits 0 parts.
Hypothesis lateness : if late_ then sp <= rs else rs <= sp.
Hypothesis first : c (S i) = a.
Hypothesis goes_ : forall q, (q < count)%nat -> (q < n)%nat -> c (S (S i) + q)%nat <= ego_go k.
Hypothesis brakes_ : forall q, (q < count)%nat -> (n <= q)%nat -> c (S (S i) + q)%nat = - ego_braking k.
Hypothesis planned : - ego_braking k <= a.

Lemma strongest_grows p q : p <= q -> strongest k p <= strongest k q.
Proof. intros. unfold strongest. destruct numbers as (_ & _ & _ & _ & _ & [? ?] & _). cases; nra. Qed.

Lemma strongest_braking : strongest k (- ego_braking k) = - weakest k (ego_braking k).
Proof. unfold strongest, weakest. rewrite Ropp_involutive, Rmax_comm. ring. Qed.

Lemma spaced j q : tau j + INR q * period k - 2 * jitter k <= tau (j + q)%nat <= tau j + INR q * period k + 2 * jitter k.
Proof. destruct grid as [g G]. pose proof (G j). pose proof (G (j + q)%nat) as G'. rewrite plus_INR in G'. lra. Qed.

Lemma tau_grows j q : (j <= q)%nat -> tau j <= tau q.
Proof.
  destruct numbers as (? & ? & ? & sp0 & _). unfold shortest_period in sp0.
  induction 1; [lra |]. pose proof (spaced m0 1) as W. replace (m0 + 1)%nat with (S m0) in W by lia. simpl INR in W. lra.
Qed.

(* Which commands may act. *)
Lemma turn q : T + sp + INR q * period k <= tau (S (S i) + q)%nat /\
               tau (S (S i) + q)%nat + latency k <= T + sp + INR q * period k + switching k.
Proof.
  pose proof (spaced (S i) (S q)) as H. rewrite S_INR in H. replace (S i + S q)%nat with (S (S i) + q)%nat in H by lia.
  fold T in H. unfold sp, shortest_period, switching. lra.
Qed.

Lemma pulled t t' q : T <= t -> t <= t' -> t' <= E ->
  (forall j, (j <= i)%nat -> t < tau (S j) + latency k -> strongest k (c j) <= q) ->
  (t < T + sp + switching k -> strongest k a <= q) ->
  (n <> O -> T + sp < t' -> t < T + sp + INR n * period k + switching k -> strongest k (ego_go k) <= q) ->
  (T + sp + INR n * period k < t' -> - weakest k (ego_braking k) <= q) ->
  pull t' - pull t <= q * (t' - t).
Proof.
  intros lo le hi old now_ go brake. destruct numbers as (p0 & _).
  assert (begun : tau 1%nat <= T) by (apply tau_grows; lia).
  apply (pulls_up _ _ _ _ _ _ drive); [lra | exact le |].
  intros j j1 j2. destruct (le_lt_dec j i) as [e | l]; [apply old; auto |].
  destruct (Nat.eq_dec j (S i)) as [now | ne].
  { rewrite now in j2 |- *. rewrite first. apply now_. pose proof (turn 0) as H. rewrite Nat.add_0_r in H. simpl INR in H. lra. }
  set (q' := (j - S (S i))%nat). assert (J : j = (S (S i) + q')%nat) by (unfold q'; lia).
  assert (cnt : (q' < count)%nat).
  { destruct (le_lt_dec count q') as [bad |]; [exfalso | assumption].
    pose proof (tau_grows (S (S i) + count) j ltac:(lia)). unfold E in hi. lra. }
  pose proof (turn q') as [t1 _]. rewrite <- J in t1.
  pose proof (turn (S q')) as [_ t2]. replace (S (S i) + S q')%nat with (S j) in t2 by lia.
  assert (mono : forall a b, (a <= b)%nat -> INR a * period k <= INR b * period k).
  { intros. apply Rmult_le_compat_r; [lra | apply le_INR; assumption]. }
  assert (q0 : 0 <= INR q' * period k) by (apply Rmult_le_pos; [apply pos_INR | lra]).
  destruct (le_lt_dec n q') as [b | g].
  - rewrite J, brakes_, strongest_braking by assumption. apply brake. pose proof (mono n q' b). lra.
  - apply Rle_trans with (strongest k (ego_go k)).
    + apply strongest_grows. rewrite J. apply goes_; assumption.
    + pose proof (mono (S q') n g). apply go; [lia | lra | lra].
Qed.

Let r0 := start (sensed + speed_error k).
Let legs := legs_up a n late_ parts.
Let b := weakest k (ego_braking k).
Let end_ := T + total legs.

Lemma last_brakes : - b <= strongest k a.
Proof. unfold b. rewrite <- strongest_braking. apply strongest_grows, planned. Qed.

Lemma go_drives : - b <= strongest k (ego_go k).
Proof.
  unfold b. rewrite <- strongest_braking. apply strongest_grows.
  destruct numbers as (_ & _ & _ & _ & _ & [? ?] & ? & ? & w). unfold weakest in w. revert w. cases; nra.
Qed.

(* One leg, from o after the call on. *)
Definition leg_ok (o : R) (leg : R * R) := 0 <= fst leg /\ - b <= snd leg /\
  (forall t t', T <= t -> T + o - ego_lag k <= t -> t <= t' -> t' <= T + o + fst leg -> t' <= E ->
     pull t' - pull t <= snd leg * (t' - t)) /\
  (o < ego_lag k -> pull T - x T <= theta * snd leg).

Fixpoint legs_ok (o : R) (legs : list (R * R)) :=
  match legs with nil => True | leg :: rest => leg_ok o leg /\ legs_ok (o + fst leg) rest end.

Lemma th0 : 0 <= theta.
Proof. apply (follows _ _ _ _ _ _ drive). Qed.

Lemma times : 0 < sp /\ 0 <= switching k /\ rs = switching k + ego_lag k /\ 0 <= ego_lag k /\ 0 <= INR n * period k.
Proof.
  destruct numbers as (p0 & l0 & j0 & s0 & g0 & _). unfold sp, rs, response, switching.
  repeat split; try lra. apply Rmult_le_pos; [apply pos_INR | lra].
Qed.

(* Commands given before no longer act once the response is over. *)
Lemma old_gone t j : T + rs - ego_lag k <= t -> (j <= i)%nat -> t < tau (S j) + latency k -> False.
Proof.
  intros lo le lt. destruct times as (_ & _ & e & _). rewrite e in lo.
  pose proof (tau_grows (S j) (S i) ltac:(lia)) as H. fold T in H.
  destruct numbers as (_ & _ & j0 & _). unfold switching in lo. lra.
Qed.

Lemma legs_are_ok : legs_ok 0 legs.
Proof.
  destruct times as (sp0 & sw0 & rsd & lag0 & n0). pose proof last_brakes as lb. pose proof go_drives as gd. pose proof th0 as th.
  assert (goes_on_ : match n with O => false | S _ => true end = false -> n = O) by (destruct n; [auto | discriminate]).
  unfold legs, legs_up. change (shortest_period k) with sp. change (response k) with rs. set (go := match n with O => false | S _ => true end) in *.
  set (last_ := if go then Rmax (strongest k a) (strongest k (ego_go k)) else strongest k a).
  assert (L : strongest k a <= last_ /\ - b <= last_ /\ (go = true -> strongest k (ego_go k) <= last_)).
  { unfold last_. destruct go; repeat split; try (intros; discriminate); try lra; try apply Rmax_l; try (intros; apply Rmax_r).
    apply Rle_trans with (1 := lb), Rmax_l. }
  assert (ngo : go = false -> INR n * period k = 0) by (intros e; rewrite (goes_on_ e); simpl; ring).
  assert (tail : forall o, o = rs -> legs_ok o
    ((if late_ then (sp, last_) :: nil else (sp - rs, strongest k a) :: (rs, last_) :: nil) ++
     (INR n * period k, strongest k (ego_go k)) :: nil)).
  { intros o ->.
    assert (final : forall o, o = sp + rs -> leg_ok o (INR n * period k, strongest k (ego_go k))).
    { intros o ->. split; [exact n0 |]. split; [exact gd |]. cbn [fst snd]. split; [| lra].
      intros t t' ? ? ? ? ?. apply pulled; auto; try lra. intros j ? ?. exfalso. apply (old_gone t j); lra || auto. }
    assert (drop : forall t t' o d, T <= t -> T + o - ego_lag k <= t -> t <= t' -> t' <= T + o + d -> t' <= E ->
              rs <= o -> pull t' - pull t <= last_ * (t' - t)).
    { intros t t' o d ? ? ? ? ? ?. destruct L as (L1 & L2 & L3). apply pulled; auto; try lra.
      - intros j ? ?. exfalso. apply (old_gone t j); lra || auto.
      - intros nz _ _. apply L3. unfold go. destruct n; [lia | reflexivity]. }
    assert (n_ok : leg_ok (sp + rs) (INR n * period k, strongest k (ego_go k))) by (apply final; reflexivity).
    destruct late_; cbn [app legs_ok fst].
    - split; [| split; [replace (rs + sp) with (sp + rs) by ring; exact n_ok | exact I]].
      split; [cbn; lra |]. split; [apply L |]. cbn [fst snd]. split; [| lra].
      intros t t' ? ? ? ? ?. apply (drop t t' rs sp); auto. lra.
    - assert (ord : rs + (sp - rs) = sp) by ring. rewrite ord.
      split; [| split; [| split; [exact n_ok | exact I]]].
      + split; [cbn; lra |]. split; [exact lb |]. cbn [fst snd]. split; [| lra].
        intros t t' ? ? ? ? ?. apply pulled; auto; try lra.
        intros j ? ?. exfalso. apply (old_gone t j); lra || auto.
      + split; [cbn; lra |]. split; [apply L |]. cbn [fst snd]. split; [| lra].
        intros t t' ? ? ? ? ?. apply (drop t t' sp rs); auto. }
  assert (all : forall ps o, inherits o ps -> 0 <= o -> legs_ok o (map (fun p => (lasts p, highest a go p)) ps ++
    ((if late_ then (sp, last_) :: nil else (sp - rs, strongest k a) :: (rs, last_) :: nil) ++
     (INR n * period k, strongest k (ego_go k)) :: nil))).
  { induction ps as [| p ps IH]; intros o inh o0; cbn [map app]; [apply tail; exact inh |].
    destruct inh as (d0 & early & old & acc & more). cbn [legs_ok fst].
    split; [| apply IH; [exact more | lra]].
    assert (H : high p <= highest a go p /\ strongest k a <= highest a go p /\
                (later p = true -> go = true -> strongest k (ego_go k) <= highest a go p)).
    { unfold highest. destruct (later p), go; cbn; repeat split; intros; try discriminate; cases; lra. }
    destruct H as (h1 & h2 & top). assert (h3 : - b <= highest a go p) by lra.
    split; [exact d0 |]. split; [exact h3 |]. cbn [fst snd]. split.
    - intros t t' ? ? ? ? ?. apply pulled; auto; try lra.
      + intros j j1 j2. destruct (old j j1 ltac:(lra)). lra.
      + intros nz hi _. apply top; [| unfold go; destruct n; [lia | reflexivity]].
        destruct (later p) eqn:l; [reflexivity | specialize (early eq_refl); lra].
    - intros soon. destruct (acc soon) as [_ A]. apply Rle_trans with (1 := A). apply Rmult_le_compat_l; lra. }
  apply all; [exact inherited | lra].
Qed.

Lemma legs_total : total legs = sp + rs + INR n * period k.
Proof.
  unfold legs, legs_up.
  assert (sum : forall p q, total (p ++ q) = total p + total q).
  { induction p as [| [d e] p IH]; intros q; cbn; [ring | rewrite IH; ring]. }
  assert (ps : forall (f : part -> R) l o, inherits o l -> total (map (fun p => (lasts p, f p)) l) = rs - o).
  { intros f. induction l as [| p l IH]; intros o inh; cbn; [cbn in inh; lra |].
    destruct inh as (_ & _ & _ & _ & more). rewrite (IH _ more). ring. }
  rewrite !sum, (ps _ parts 0 inherited). unfold sp, rs. destruct late_; cbn; ring.
Qed.

(* (i) 3: the ego is no faster than the legs say, and once they are over it brakes. *)
Let bound u := if Rle_dec (u - T) (total legs) then speed_at r0 legs (u - T)
               else Rmax 0 (speed_at r0 legs (total legs) - b * (u - T - total legs)).

Lemma b_pos : 0 < b.
Proof. unfold b. apply numbers. Qed.

Lemma ok_ordered o ls : legs_ok o ls -> ordered ls /\ Forall (fun leg => - b <= snd leg) ls.
Proof.
  revert o. induction ls as [| leg ls IH]; intros o H; [split; constructor |].
  destruct H as [(d0 & q0 & _) more]. destruct (IH _ more). split; constructor; auto.
Qed.

Lemma bound_nonneg u : 0 <= bound u.
Proof.
  unfold bound. destruct (Rle_dec (u - T) (total legs)); [apply speed_at_nonneg; apply Rmax_r | apply Rmax_l].
Qed.

Lemma no_faster u : v T <= sensed + speed_error k -> T <= u <= E -> v u <= bound u.
Proof.
  intros vT [lo hi]. destruct times as (sp0 & sw0 & rsd & lag0 & n0).
  pose proof (legs_are_ok) as ok. destruct (ok_ordered 0 legs ok) as [ord hard].
  pose proof (total_nonneg legs ord) as t0. pose proof b_pos as b0. pose proof (forwards s v m) as pos.
  assert (start_ : bound T = speed r0).
  { unfold bound. replace (T - T) with 0 by ring. destruct (Rle_dec 0 (total legs)); [| lra].
    apply speed_at_first; [exact ord | apply Rmax_r]. }
  assert (vr : v T <= bound T) by (rewrite start_; cbn; pose proof (pos T); cases; lra).
  assert (above : forall u, T <= u -> Rmin 0 (bound T) <= bound u).
  { intros w _. apply Rle_trans with (1 := Rmin_l _ _). apply bound_nonneg. }
  apply (lag_is_a_delay theta (ego_lag k) 0 T v x pull bound) with (E := u); auto; try lra; try apply drive.
  (* The legs are pieces of the bound. *)
  assert (chain : forall ls r o, 0 <= speed r -> 0 <= o -> legs_ok o ls -> o + total ls <= total legs ->
            (forall w, T + o <= w <= T + o + total ls -> bound w = speed_at r ls (w - T - o)) ->
            forall e, T + o <= e -> e <= E -> e <= T + o + total ls -> pieces theta (ego_lag k) T x pull bound (T + o) e).
  { induction ls as [| [d q] ls IH]; intros r o rr0 o0 lok tot same e e1 e2 e3.
    - cbn in e3. replace e with (T + o) by lra. apply no_piece. lra.
    - destruct lok as [(d0 & q0 & fol & had_) more]. cbn [fst snd total] in *.
      destruct (ok_ordered _ _ more) as [ord' _]. pose proof (total_nonneg ls ord').
      assert (one : forall e', T + o <= e' <= T + o + d -> e' <= E -> piece theta (ego_lag k) T x pull bound q (T + o) e').
      { intros e' [? ?] ?. constructor; [lra | | |].
        - intros t t' ? ? ? ?. apply fol; lra.
        - intros soon. apply had_. lra.
        - intros t t' ? ? ?. rewrite !same by lra. cbn [speed_at].
          destruct (Rle_dec (t - T - o) d); [| lra]. destruct (Rle_dec (t' - T - o) d); [| lra].
          pose proof (at_most_rises r q (t - T - o) (t' - T - o) rr0 ltac:(lra)) as R.
          replace (t' - T - o - (t - T - o)) with (t' - t) in R by ring. exact R. }
      destruct (Rle_dec e (T + o + d)) as [within | beyond].
      + apply one_more with (q := q) (t2 := e); [apply one; lra | apply no_piece; lra].
      + apply one_more with (q := q) (t2 := T + o + d); [apply one; lra |].
        replace (T + o + d) with (T + (o + d)) by ring. apply (IH (at_most r q d)); auto; try lra; [apply at_most_keeps |].
        intros w [? ?]. rewrite same by lra. cbn [speed_at].
        destruct (Rle_dec (w - T - o) d) as [at_end | ?].
        * assert (we : w - T - o = d) by lra. replace (w - T - (o + d)) with 0 by lra. rewrite we.
          symmetry. apply speed_at_first; [exact ord' | apply at_most_keeps].
        * replace (w - T - (o + d)) with (w - T - o - d) by ring. reflexivity. }
  assert (first_legs : forall e, T <= e -> e <= E -> e <= T + total legs -> pieces theta (ego_lag k) T x pull bound T e).
  { intros e ? ? ?. replace T with (T + 0) at 2 by ring. apply (chain legs r0); auto; try lra; [apply Rmax_r |].
    intros w [? ?]. unfold bound. replace (w - T - 0) with (w - T) by ring.
    destruct (Rle_dec (w - T) (total legs)); [reflexivity | lra]. }
  destruct (Rle_dec u (T + total legs)) as [early | late_u]; [apply first_legs; lra |].
  assert (join : forall p q r, pieces theta (ego_lag k) T x pull bound p q -> pieces theta (ego_lag k) T x pull bound q r ->
            pieces theta (ego_lag k) T x pull bound p r).
  { intros p q r H. induction H; auto. intros. apply one_more with (1 := H). auto. }
  apply join with (T + total legs); [apply first_legs; lra |].
  apply one_more with (q := - b) (t2 := u); [| apply no_piece; lra].
  rewrite legs_total in *.
  constructor; [lra | | |].
  - pose proof b_pos as bp. intros t t' ? ? ? ?. apply pulled; try lra.
    + intros j ? ?. exfalso. apply (old_gone t j); lra || auto.
    + fold b. lra.
  - intros soon. exfalso. lra.
  - intros t t' ? ? ?. unfold bound. rewrite legs_total.
    set (V := speed_at r0 legs (sp + rs + INR n * period k)).
    assert (V0 : 0 <= V) by (apply speed_at_nonneg, Rmax_r).
    set (W := sp + rs + INR n * period k) in *.
    destruct (Rle_dec (t - T) W), (Rle_dec (t' - T) W); try (exfalso; lra).
    + replace (t - T) with W by lra. replace (t' - T) with W by lra. replace (t' - t) with 0 by lra. lra.
    + replace (t - T) with W by lra. fold V. assert (e : t' - t = t' - T - W) by lra. rewrite e. cases; lra.
    + assert (0 <= b * (t' - t)) by (apply Rmult_le_pos; lra). cases; lra.
Qed.

(* (i) 4: from any moment on the ego would, if it braked, be at rest by the place that is verified. *)
Theorem stops_where_planned u : v T <= sensed + speed_error k -> T <= u <= E ->
  s u - s T + v u * v u / (b + b) <= rest_of (after_legs legs r0) b.
Proof.
  intros vT [lo hi]. pose proof legs_are_ok as ok. destruct (ok_ordered 0 legs ok) as [ord hard].
  pose proof (total_nonneg legs ord) as t0. pose proof b_pos as bp.
  assert (rr0 : 0 <= speed r0) by apply Rmax_r.
  destruct (legs_hold s v (s T) b E legs m bp r0 T ord hard rr0) as [during at_end].
  { intros t [? ?] ?. pose proof (no_faster t vT ltac:(lra)) as F. unfold bound in F.
    destruct (Rle_dec (t - T) (total legs)); [exact F | lra]. }
  { cbn. lra. }
  destruct (Rle_dec u (T + total legs)) as [early | late_u]; [apply during; lra |].
  destruct (at_end ltac:(lra)) as [D V]. set (r4 := after_legs legs r0) in *.
  assert (V4 : speed_at r0 legs (total legs) = speed r4) by (apply speed_at_last; auto).
  pose proof (brakes_out s v b (speed r4) (T + total legs) u m bp) as B.
  assert (V40 : 0 <= speed r4) by (rewrite <- V4; apply speed_at_nonneg; exact rr0).
  specialize (B V40 ltac:(lra)). unfold rest_of.
  assert (s u - s (T + total legs) + v u * v u / (b + b) <= speed r4 * speed r4 / (b + b)); [| lra].
  apply B. intros t [? ?]. pose proof (no_faster t vT ltac:(lra)) as F. unfold bound in F.
  destruct (Rle_dec (t - T) (total legs)) as [e | ne].
  - assert (t = T + total legs) by lra. subst t. replace (T + total legs - T) with (total legs) in F by ring.
    rewrite V4 in F. replace (T + total legs - (T + total legs)) with 0 by ring. cases; lra.
  - rewrite V4 in F. replace (t - (T + total legs)) with (t - T - total legs) by ring. exact F.
Qed.
End Plan.
End Drive.
